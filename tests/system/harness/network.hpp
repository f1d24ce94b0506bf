#pragma once

#include <string>

namespace planemap::system_test {

/// Moves this process, and all it starts from now on, into a network namespace of its own with nothing but lo, up:
/// nothing leaves the machine, and tests don't disturb each other. Call it before the first thread is started.
/// @return why it was not possible, in words; empty: done
std::string enter_own_network();

/// Gives the namespace what LCM needs: multicast on lo and a route for it. Throws std::runtime_error if `ip` fails.
void add_multicast_route();
void remove_multicast_route();

/// Loses datagrams to LCM's port at random in that namespace, until it is set anew. Throws std::runtime_error if `nft`
/// fails.
/// @param percent  0 to 100; 0: none
void lose_datagrams(int percent);

/// Loses all TCP to and from a port in that namespace, as where a cable was pulled, or no more. Throws
/// std::runtime_error if `nft` fails.
void cut_off_tcp(int port);
void mend_tcp();

/// LCM in that namespace, with a receive buffer for scans.
extern const char* const kLcmUrl;

/// Greatest receive buffer a socket may ask for, bytes (net.core.rmem_max), as it was before enter_own_network().
long greatest_receive_buffer();

}  // namespace planemap::system_test
