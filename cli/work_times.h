#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

#include "server/storage/store.h"

namespace pangaea {

// How long the server's work took, kind by kind in the order in which work goes: count, median and 95th percentile, by
// the wall clock and of processor time. Empty where there are no times.
std::string FormatWorkTimes(std::span<const WorkTime> times);
nlohmann::json WorkTimesJson(std::span<const WorkTime> times);

}  // namespace pangaea
