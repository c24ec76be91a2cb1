#pragma once
// Which channels an image has, from its header alone.

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace patina {

/// The channels of any image that OpenImageIO reads.
class ImageChannels {
  public:
    explicit ImageChannels(std::vector<std::string> names) : names_(std::move(names)) {}
    explicit ImageChannels(const std::filesystem::path& file);

    /// Why the file cannot be read as an image; empty where it can.
    const std::string& failure() const { return failure_; }
    const std::vector<std::string>& names() const { return names_; }
    /// \param channel  a channel's name ("R", "Y", …) or its number from 0
    /// \return its number, where there is one
    std::optional<int> find(const std::string& channel) const;

  private:
    std::vector<std::string> names_;
    std::string failure_;
};

} // namespace patina
