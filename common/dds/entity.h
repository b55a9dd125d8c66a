#pragma once

#include <cstdint>
#include <utility>

namespace pangaea {

// Owns one entity of the DDS library: a domain, participant, topic, reader, writer or waitset. Deleted with its owner.
class DdsEntity {
 public:
  DdsEntity() = default;
  explicit DdsEntity(std::int32_t handle) : handle_(handle) {}
  ~DdsEntity() { Reset(); }
  DdsEntity(DdsEntity&& other) noexcept : handle_(std::exchange(other.handle_, 0)) {}
  DdsEntity& operator=(DdsEntity&& other) noexcept {
    if (this != &other) {
      Reset();
      handle_ = std::exchange(other.handle_, 0);
    }
    return *this;
  }

  std::int32_t get() const { return handle_; }
  void Reset();

 private:
  std::int32_t handle_ = 0;  // 0 is none
};

}  // namespace pangaea
