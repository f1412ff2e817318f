#pragma once

// Compiled once for the window: Qt's headers are most of what its files take to compile. Files still include what they
// use.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include <glm/glm.hpp>

#include <QtGui>
#include <QtWidgets>
