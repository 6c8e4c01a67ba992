#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace waymark {

/// The number of one thing among its kind. It opens an IndexedVector of its own kind only, and
/// becomes a number again only when asked (`value`).
template <typename Kind>
class Index {
 public:
  constexpr Index() = default;
  explicit constexpr Index(std::size_t value) : value_(static_cast<std::uint32_t>(value)) {}
  [[nodiscard]] constexpr std::size_t value() const { return value_; }
  friend constexpr auto operator<=>(const Index&, const Index&) = default;

 private:
  std::uint32_t value_ = 0;
};

/// The indices from `first` on, `count` of them.
template <typename Key>
class IndexRange {
 public:
  class Iterator {
   public:
    using value_type = Key;
    using difference_type = std::ptrdiff_t;
    using reference = Key;
    using pointer = const Key*;
    using iterator_category = std::input_iterator_tag;
    constexpr explicit Iterator(std::size_t at = 0) : at_(at) {}
    constexpr Key operator*() const { return Key(at_); }
    constexpr Iterator& operator++() {
      ++at_;
      return *this;
    }
    constexpr Iterator operator++(int) {
      Iterator before = *this;
      ++at_;
      return before;
    }
    friend constexpr bool operator==(const Iterator&, const Iterator&) = default;

   private:
    std::size_t at_;
  };

  constexpr IndexRange() = default;
  constexpr IndexRange(std::size_t first, std::size_t count) : first_(first), count_(count) {}
  [[nodiscard]] constexpr Iterator begin() const { return Iterator(first_); }
  [[nodiscard]] constexpr Iterator end() const { return Iterator(first_ + count_); }
  [[nodiscard]] constexpr std::size_t size() const { return count_; }
  [[nodiscard]] constexpr bool empty() const { return count_ == 0; }

 private:
  std::size_t first_ = 0;
  std::size_t count_ = 0;
};

/// A vector that one kind of index opens.
template <typename Key, typename T>
class IndexedVector {
 public:
  IndexedVector() = default;
  explicit IndexedVector(std::size_t count) : values_(count) {}
  IndexedVector(std::size_t count, const T& value) : values_(count, value) {}
  explicit IndexedVector(std::vector<T> values) : values_(std::move(values)) {}

  [[nodiscard]] T& operator[](Key key) { return values_[key.value()]; }
  [[nodiscard]] const T& operator[](Key key) const { return values_[key.value()]; }
  [[nodiscard]] std::size_t size() const { return values_.size(); }
  [[nodiscard]] bool empty() const { return values_.empty(); }
  [[nodiscard]] IndexRange<Key> indices() const { return {0, values_.size()}; }
  [[nodiscard]] const std::vector<T>& values() const { return values_; }

  Key push_back(T value) {
    values_.push_back(std::move(value));
    return Key(values_.size() - 1);
  }
  void resize(std::size_t count) { values_.resize(count); }
  void assign(std::size_t count, const T& value) { values_.assign(count, value); }

  [[nodiscard]] auto begin() { return values_.begin(); }
  [[nodiscard]] auto end() { return values_.end(); }
  [[nodiscard]] auto begin() const { return values_.begin(); }
  [[nodiscard]] auto end() const { return values_.end(); }
  [[nodiscard]] T& front() { return values_.front(); }
  [[nodiscard]] const T& front() const { return values_.front(); }
  [[nodiscard]] T& back() { return values_.back(); }
  [[nodiscard]] const T& back() const { return values_.back(); }
  friend bool operator==(const IndexedVector&, const IndexedVector&) = default;

 private:
  std::vector<T> values_;
};

}  // namespace waymark
