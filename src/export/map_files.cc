#include "export/map_files.h"

#include "base/atomic_file.h"
#include "export/texture_file.h"

#include <utility>

namespace patina {

struct MapFiles::Texture {
    std::string name;
    AtomicFile file;
};

MapFiles::MapFiles(std::filesystem::path folder, std::vector<std::pair<std::string, std::string>> texts)
    : folder_(std::move(folder)), texts_(std::move(texts)) {}

MapFiles::~MapFiles() = default;

void MapFiles::begin(const std::vector<MapInfo>& maps) {
    first_ = files_.size();
    for (MapInfo info : maps) {
        info.texts.insert(info.texts.end(), texts_.begin(), texts_.end());
        files_.push_back(std::make_unique<ExrWriter>(info, folder_ / (info.fileStem() + ".exr")));
        infos_.push_back(std::move(info));
    }
}

void MapFiles::write(int map, const void* rows, int count) { files_[first_ + map]->write(rows, count); }

void MapFiles::end() {
    for (std::size_t i = first_; i < files_.size(); ++i)
        files_[i]->finish();
}

void MapFiles::finish(const std::vector<std::vector<std::pair<std::string, float>>>& numbers) {
    for (std::size_t i = 0; i < files_.size(); ++i)
        files_[i]->setNumbers(numbers[i % numbers.size()]);
}

void MapFiles::makeTextures(Progress& progress) {
    for (std::size_t i = 0; i < files_.size(); ++i) {
        progress.checkpoint();
        const std::string name = infos_[i].fileStem() + ".tx";
        textures_.push_back(std::unique_ptr<Texture>(new Texture{name, AtomicFile(folder_ / name)}));
        makeTx(files_[i]->temporary(), textures_.back()->file.temporary(), folder_ / name);
        progress.update(static_cast<double>(i + 1) / static_cast<double>(files_.size()));
    }
}

std::vector<std::string> MapFiles::commit() {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < files_.size(); ++i) {
        files_[i]->commit();
        names.push_back(infos_[i].fileStem() + ".exr");
        if (i < textures_.size()) {
            textures_[i]->file.commit();
            names.push_back(textures_[i]->name);
        }
    }
    return names;
}

} // namespace patina
