#pragma once

namespace planemap::service {

/// Gives the calling thread, and no other, a smaller share of a core that others want too: the work that others wait
/// for goes first. Under Linux nice values are of threads; elsewhere this does nothing.
/// @param steps  of nice, 1 to 19; each a fifth less. What cannot be set stays as it is.
void run_in_background(int steps) noexcept;

}  // namespace planemap::service
