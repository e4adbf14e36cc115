#pragma once

#include <memory>
#include <utility>

namespace servoctl {

/// A value that is kept elsewhere, so that a variant that may hold it stays small. Copies as the value does;
/// one that was moved from holds none.
template <class T>
class Boxed {
 public:
  explicit Boxed(T value) : value_(std::make_unique<T>(std::move(value))) {}
  Boxed(const Boxed& other) : value_(other.value_ ? std::make_unique<T>(*other.value_) : nullptr) {}
  Boxed(Boxed&&) noexcept = default;
  Boxed& operator=(const Boxed& other) { return *this = Boxed(other); }
  Boxed& operator=(Boxed&&) noexcept = default;
  ~Boxed() = default;

  /// Null where there is none.
  const T* get() const { return value_.get(); }
  T* get() { return value_.get(); }

 private:
  std::unique_ptr<T> value_;
};

}  // namespace servoctl
