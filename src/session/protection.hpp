#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <set>
#include <utility>

namespace servoctl::session {

/// What would be left alone if the process ended now; the worst of it.
enum class Care : std::uint8_t {
  none,
  unsettled,  ///< Something was begun at a drive, or with an interface, and is put in order.
  energised,  ///< A drive that was left energised knowingly.
  guarded,    ///< A drive in motion, or on its way out of one.
};

/// Counts what must not be left unattended. The holder takes a Hold and releases it by destroying it:
/// so nobody can forget it, and nobody ends what another still needs. Outlives its holds, which several
/// threads may have.
class Protection {
 public:
  /// Called with the highest care whenever it changes: before a drive is energised, and after it is at rest.
  using OnChange = std::function<void(Care worst)>;

  explicit Protection(OnChange on_change = {}) : on_change_(std::move(on_change)) {}
  Protection(const Protection&) = delete;
  Protection& operator=(const Protection&) = delete;

  class Hold {
   public:
    Hold() = default;
    /// Holds nothing where `protection` is null.
    Hold(Protection* protection, Care care) : protection_(protection), care_(care) {
      if (protection_ != nullptr) protection_->add(care_);
    }
    Hold(Hold&& other) noexcept
        : protection_(std::exchange(other.protection_, nullptr)), care_(other.care_) {}
    Hold& operator=(Hold&& other) noexcept {
      std::swap(protection_, other.protection_);
      std::swap(care_, other.care_);
      return *this;
    }
    ~Hold() { release(); }

    bool is_held() const { return protection_ != nullptr; }
    void release() {
      if (auto* const held = std::exchange(protection_, nullptr)) held->remove(care_);
    }

   private:
    Protection* protection_ = nullptr;
    Care care_ = Care::none;
  };

  Care worst() const;

 private:
  void add(Care care);
  void remove(Care care);
  void tell(Care before) const;

  Care highest() const;

  OnChange on_change_;
  mutable std::mutex mutex_;
  std::array<std::size_t, 4> held_{};  ///< By Care. Under the mutex.
};

/// The drives that were left energised, by their node-ID; protected as long as there is one.
class EnergisedNodes {
 public:
  explicit EnergisedNodes(Protection* protection = nullptr) : protection_(protection) {}
  EnergisedNodes(const EnergisedNodes&) = delete;
  EnergisedNodes& operator=(const EnergisedNodes&) = delete;
  EnergisedNodes(EnergisedNodes&&) = default;
  EnergisedNodes& operator=(EnergisedNodes&&) = default;
  ~EnergisedNodes() = default;

  void insert(std::uint8_t node);
  void erase(std::uint8_t node);
  bool empty() const { return nodes_.empty(); }
  bool contains(std::uint8_t node) const { return nodes_.contains(node); }
  const std::set<std::uint8_t>& nodes() const { return nodes_; }

 private:
  Protection* protection_;
  Protection::Hold hold_;
  std::set<std::uint8_t> nodes_;
};

}  // namespace servoctl::session
