// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <iosfwd>

#include "serve/service.h"
#include "serve/unix_socket.h"
#include "stop_signal.h"

namespace keepout::app {

/// Serves one client over stdin and stdout until he ends, or `stop`. Returns an exit status.
/// `log`: for people.
int serve_stdio(Service& service, const StopSignal& stop, std::ostream& log);

/// Serves clients of a socket, in turn, until `stop`. One more than `most_clients` at a time is
/// told so, and left.
int serve_socket(Service& service, const StopSignal& stop, UnixSocket& socket,
                 std::size_t most_clients);

}  // namespace keepout::app
