// Compiled once for the tests of mapbuilder's rooms.
#include "precompiled_mapping.h"
#include "precompiled_tests.h"
