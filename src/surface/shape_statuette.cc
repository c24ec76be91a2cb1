#include "surface/shape_builder.h"
#include "surface/shape_makers.h"
namespace patina { Mesh makeStatuette() { return makeSphere(); } }
