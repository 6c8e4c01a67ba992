// Compiled once for tests.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "precompiled_common.h"
