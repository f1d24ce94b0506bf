#pragma once

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace planemap {

/// Why something from outside could not be used: what and where, in a sentence for the person who has to mend it.
struct Error {
  std::string message;
};

/// A value, or the reason why there is none.
template <class T>
using Expected = tl::expected<T, Error>;

/// Makes the failing side of an Expected.
inline tl::unexpected<Error> fail(std::string message) {
  return tl::make_unexpected(Error{std::move(message)});
}

}  // namespace planemap
