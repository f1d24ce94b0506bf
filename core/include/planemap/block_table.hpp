#pragma once

#include <memory>
#include <planemap/paged_sequence.hpp>

namespace planemap {

class Block;

/// The blocks of a map, in the order in which they were made.
using BlockTable = PagedSequence<std::shared_ptr<const Block>>;

}  // namespace planemap
