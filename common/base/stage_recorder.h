#pragma once

#include <string_view>

namespace pangaea {

// Where core code says which stage of the work it is in. Core code has no clock: the shell that calls it brings a
// recorder that measures. One recorder belongs to one thread.
class StageRecorder {
 public:
  virtual ~StageRecorder() = default;
  // `name` outlives the recorder: a string literal such as "tracking.pose".
  virtual void Begin(std::string_view name) = 0;
  virtual void End(std::string_view name) = 0;
};

// A recorder that measures nothing.
class NoStageRecorder final : public StageRecorder {
 public:
  void Begin(std::string_view) override {}
  void End(std::string_view) override {}
};

// The stage lasts as long as this object. Stages may nest.
class StageScope {
 public:
  StageScope(StageRecorder& recorder, std::string_view name) : recorder_(recorder), name_(name) {
    recorder_.Begin(name_);
  }
  ~StageScope() { recorder_.End(name_); }
  StageScope(const StageScope&) = delete;
  StageScope& operator=(const StageScope&) = delete;

 private:
  StageRecorder& recorder_;
  std::string_view name_;
};

}  // namespace pangaea
