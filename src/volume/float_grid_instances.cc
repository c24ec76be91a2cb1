#include "volume/grid_instances.h"

PATINA_GRID_INSTANCES(, FloatTree);
