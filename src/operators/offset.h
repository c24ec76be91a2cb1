#pragma once
// offset material radius (paper §3.2; Miller 1994, his second version): closing by a ball.

#include "operators/surface_operation.h"

#include <string>

namespace patina {

/// An infinitely thick coat minus everything that a ball of `radius` can reach from outside: fills what is narrower
/// than the ball and rounds inner corners, phi_{n+1} = min(phi_n, closing of phi_n).
///
/// Where nothing is filled no bit changes and no layer is added (nor the band grown): exactly where the largest tangent
/// sphere is no smaller than the ball (volume/closing.h). The back of a sheet takes nothing.
/// \param radius  scene units, > 0; a length of the model: exaggeration does not scale it
/// \param global  only balls that can come from outside count: a hole that the ball cannot leave is filled
/// \throws RunError where the radius is not positive; Interrupted
OperationReport offset(Workpiece& work, const std::string& material, double radius, bool global, Progress& progress);

} // namespace patina
