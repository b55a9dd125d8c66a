#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <utility>

namespace pangaea {

// Says which nodes one atlas alone may change in place: those that carry its mark. Copying a mark gives both sides new
// ones, so from then on what they share is changed by neither; no reference count is ever read to decide that.
class WriteMark {
 public:
  WriteMark() : value_(Next()) {}
  WriteMark(const WriteMark& other) : value_(Next()) { other.Renew(); }
  WriteMark(WriteMark&& other) noexcept : value_(other.value()) { other.Renew(); }
  WriteMark& operator=(const WriteMark& other) {
    if (this == &other) return *this;
    Renew();
    other.Renew();
    return *this;
  }
  WriteMark& operator=(WriteMark&& other) noexcept {
    if (this == &other) return *this;
    value_.store(other.value(), std::memory_order_relaxed);
    other.Renew();
    return *this;
  }
  ~WriteMark() = default;

  std::uint64_t value() const { return value_.load(std::memory_order_relaxed); }

 private:
  static std::uint64_t Next() {
    static std::atomic<std::uint64_t> last{0};
    return last.fetch_add(1, std::memory_order_relaxed) + 1;
  }
  void Renew() const { value_.store(Next(), std::memory_order_relaxed); }

  // Atomic and mutable: several readers may copy one const snapshot at the same time.
  mutable std::atomic<std::uint64_t> value_;
};

// A value that copies share until one of them writes.
template <typename T>
class CopyOnWrite {
 public:
  // nullptr before the first Write.
  const T* get() const { return node_ ? &node_->value : nullptr; }

  // The value to change in place, copied first where it may be shared.
  T& Write(const WriteMark& mark) {
    if (!node_) {
      node_ = std::make_shared<Node>(mark.value());
    } else if (node_->mark != mark.value()) {
      node_ = std::make_shared<Node>(mark.value(), node_->value);
    }
    return node_->value;
  }

 private:
  struct Node {
    explicit Node(std::uint64_t node_mark) : mark(node_mark) {}
    Node(std::uint64_t node_mark, const T& node_value) : mark(node_mark), value(node_value) {}
    std::uint64_t mark;
    T value{};
  };
  std::shared_ptr<Node> node_;
};

}  // namespace pangaea
