#pragma once

#include <limits>
#include <sstream>
#include <string>
#include <string_view>

#include "common/base/result.h"

namespace pangaea {

// What a Check() of options is made of: collects the first option that is out of its range. `owner` names whose options
// they are in the message.
class RangeCheck {
 public:
  static constexpr double kUnlimited = std::numeric_limits<double>::max();

  explicit RangeCheck(std::string_view owner) : owner_(owner) {}

  template <typename Number>
  RangeCheck& In(const char* name, Number value, double low, double high) {
    const double number = static_cast<double>(value);
    if (!status_.has_value() || (number >= low && number <= high)) return *this;
    std::ostringstream message;
    message << owner_ << ": " << name << " is " << number << ", allowed are " << low << " to ";
    if (high == kUnlimited) {
      message << "any number";
    } else {
      message << high;
    }
    status_ = Fail(ErrorCode::kInvalidArgument, message.str());
    return *this;
  }
  const Status& status() const { return status_; }

 private:
  std::string owner_;
  Status status_;
};

}  // namespace pangaea
