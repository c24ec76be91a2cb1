#include "base/progress.h"

#include "base/errors.h"

namespace patina {

void Progress::begin(const std::string&) {}
void Progress::update(double) {}
void Progress::end() {}

void Progress::checkpoint() const {
    if (cancelled())
        throw Interrupted();
}

} // namespace patina
