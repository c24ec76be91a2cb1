#pragma once
// The makers behind makeShape(), one per shape.

#include "surface/mesh.h"

namespace patina {

Mesh makePlate();     ///< 0.1 x 0.1 m, open, facing +z
Mesh makeStrip();     ///< 0.30 (x) x 0.10 m (y), open, facing +z
Mesh makeSphere();    ///< radius 0.05 m, resting on z = 0
Mesh makeGroove();    ///< a block 0.12 x 0.06 x 0.02 m whose top has slots and V-grooves
Mesh makeTower();     ///< a turret about 6 m tall, with window bays, a ribbed dome and a lantern
Mesh makeStatuette(); ///< a seated figure on a lotus throne, 0.25 m tall, looking towards -y

} // namespace patina
