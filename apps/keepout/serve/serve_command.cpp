// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "serve/serve_command.h"

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <ostream>

#include "keepout/error.h"
#include "named_mesh.h"
#include "number_text.h"
#include "progress.h"
#include "serve/server.h"
#include "serve/unix_socket.h"
#include "stop_signal.h"

namespace keepout::app {
namespace {

/// Otherwise the next file that is opened would be taken for it.
void require_stdio() {
  for (const int file : {STDIN_FILENO, STDOUT_FILENO}) {
    if (::fcntl(file, F_GETFD) < 0) {
      throw Error(
          "stdin or stdout is closed: 'keepout serve' reads requests from the one and answers on "
          "the other; connect both, or give --socket");
    }
  }
}

}  // namespace

int serve(const ServeOptions& options, std::ostream& log) {
  if (!options.socket) require_stdio();
  const LoadedMesh loaded = load_named_mesh(options.service.mesh, options.load);
  ServiceSettings settings = options.service;
  settings.constraint.warn = warn_on_stderr;
  settings.space = loaded.space;
  Service service(loaded.mesh, settings);
  const StopSignal stop;
  ::signal(SIGPIPE, SIG_IGN);  // a client who has gone is an error of write() alone
  const auto tell_where = [&](const std::string& where) {
    log << "keepout: serving " << options.service.mesh.string() << " ("
        << counted(loaded.mesh->triangle_count(), "triangle") << ") on " << where << std::endl;
  };
  if (!options.socket) {
    tell_where("stdin and stdout");
    return serve_stdio(service, stop, log);
  }
  UnixSocket socket(*options.socket);
  tell_where(options.socket->string());
  return serve_socket(service, stop, socket, options.most_clients);
}

const std::string_view protocol_help =
    R"(One JSON object a line, answered in order by one line with the same id. Lengths in mm, in the
frame of the mesh. Lines for people go to stderr.

  {"id":1,"do":"step","tip":[0,0,60],"desired":[0,0,-0.5]}
  {"id":1,"ok":true,"status":"free","motion":[0,0,-0.5],"triangles":0,"planes":0,"distance":10}

step      tip, desired: the motion that the tip may make instead of the desired one; zero unless ok.
          'distance' is that of the tip from the surface, before it.
          With jacobian, three rows of n numbers: 'increment' is that of the joints.
          With rows and bounds: rows . u >= bounds holds for the increment u.
steps     motions, an array of [px,py,pz,dx,dy,dz]: as many steps, answered as "steps".
polytope  tip, radius: normals and offsets of the free space around it, normal . d >= offset.
info      version, mesh, settings and limits.
statuses  all statuses by name, each with its reason.
ping      whether it is there.

A line that cannot be carried out is answered, moves nothing and ends nothing:

  {"id":2,"error":{"kind":"not_a_request","message":"'tip' must be an array of three numbers"}}

kinds: line_too_long, not_json, not_a_request, too_many_clients. All of it: docs/serve.md
)";

}  // namespace keepout::app
