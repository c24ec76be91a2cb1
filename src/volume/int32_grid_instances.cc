#include "volume/grid_instances.h"

PATINA_GRID_INSTANCES(, Int32Tree);
