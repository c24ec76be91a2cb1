#pragma once
// Outputs are written under a temporary name in the same folder and renamed when they are whole.

#include <filesystem>

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

/// Makes a folder (and its parents) and checks that files can be written in it.
/// \throws RunError when not.
void makeWritableFolder(const std::filesystem::path& folder);

/// Writes a whole text file, atomically.
void writeTextFile(const std::filesystem::path& path, const std::string& text);

/// Reads a whole file. \throws RunError when it cannot be read.
std::string readTextFile(const std::filesystem::path& path);

} // namespace patina
