#pragma once
// The fields of a whole model, read where a close-up needs them.

#include <Imath/ImathBox.h>
#include <Imath/ImathVec.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace patina {

/// Field grids (exposure, accessibility, …) of a volume that `run` wrote of the whole model. Only what lies in a box
/// is kept. Safe from any thread.
class ContextFields {
  public:
    /// \param box  model coordinates, scene units; a few of the volume's own voxels around it are read as well
    /// \throws RunError as readVolume() does, and where the file's model has another unit
    ContextFields(const std::filesystem::path& file, const Imath::Box3d& box, double metresPerUnit);
    ~ContextFields();
    ContextFields(ContextFields&&) noexcept;

    /// Names of the fields, sorted.
    const std::vector<std::string>& names() const { return names_; }
    /// The number of a field, -1 where there is none of this name.
    int find(const std::string& name) const;

    /// A field near a point of the surface (model coordinates): linear between the voxels around it that hold values;
    /// where there are none, the nearest within two voxels; else 0.
    double value(int field, const Imath::V3d& position) const;

  private:
    struct Grids;
    std::vector<std::string> names_;
    std::unique_ptr<Grids> grids_;
};

} // namespace patina
