#pragma once
// Baked maps as files of a folder.

#include "export/bake.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace patina {

/// Writes maps as EXR files while they are baked: NAME.exr, or NAME.1001.exr … where the model has several UV tiles. All
/// or nothing: the files take their names in commit(), and what was not committed is removed.
class MapFiles : public MapSink {
  public:
    /// \param texts  attributes of every file
    MapFiles(std::filesystem::path folder, std::vector<std::pair<std::string, std::string>> texts);
    ~MapFiles() override;

    void begin(const std::vector<MapInfo>& maps) override;
    void write(int map, const void* rows, int count) override;
    void end() override;
    void finish(const std::vector<std::vector<std::pair<std::string, float>>>& numbers) override;

    /// After finish(): also makes the .tx of each map (texture_file.h). \throws RunError, Interrupted
    void makeTextures(Progress& progress);
    /// \return the files' names, in the order of the maps. \throws RunError
    std::vector<std::string> commit();

  private:
    struct Texture;
    std::filesystem::path folder_;
    std::vector<std::pair<std::string, std::string>> texts_;
    std::vector<MapInfo> infos_;
    std::vector<std::unique_ptr<ExrWriter>> files_;
    std::vector<std::unique_ptr<Texture>> textures_;
    std::size_t first_ = 0; ///< of the tile that is being baked
};

} // namespace patina
