#pragma once
// Precompiled: what almost every file includes, directly or not. Nothing may depend on it: files include what they use.

#include <fmt/format.h>
#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>
