// Compiled once for tests.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "precompiled_common.h"
