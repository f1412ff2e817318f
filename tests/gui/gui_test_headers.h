#pragma once

// Compiled once for the tests of the window. Tests still include what they use.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <QTest>

#include "ui/widgets/widget_headers.h"
