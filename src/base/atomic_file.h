#pragma once
// Outputs are written under a temporary name in the same folder and renamed when they are whole.

#include <filesystem>
#include <vector>

namespace patina {

/// Write to `temporary()`, then `commit()`. Without a commit the temporary file is removed, so nothing
/// half-written is ever left and an older file of the final name survives a failure.
/// The temporary name keeps the extension (writers choose their format by it).
class AtomicFile {
  public:
    /// \throws RunError when the folder does not exist or cannot be written.
    explicit AtomicFile(std::filesystem::path final);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    const std::filesystem::path& temporary() const { return temporary_; }
    /// \throws RunError when the temporary file is missing or cannot be renamed.
    void commit();

  private:
    std::filesystem::path final_;
    std::filesystem::path temporary_;
};

/// A folder for outputs. What fails before anything is written in it leaves no trace: of the folders made here those
/// that are still empty at the end are removed.
class OutputFolder {
  public:
    /// Makes the folder (and its parents) where it does not exist, and checks that files can be written in it.
    /// \throws RunError when not.
    explicit OutputFolder(std::filesystem::path folder);
    ~OutputFolder();
    OutputFolder(OutputFolder&&) = default;

    const std::filesystem::path& path() const { return folder_; }

  private:
    void removeEmpty();

    std::filesystem::path folder_;
    std::vector<std::filesystem::path> made_; ///< the deepest first
};

/// Writes a whole text file, atomically.
void writeTextFile(const std::filesystem::path& path, const std::string& text);

/// Reads a whole file. \throws RunError when it cannot be read.
std::string readTextFile(const std::filesystem::path& path);

} // namespace patina
