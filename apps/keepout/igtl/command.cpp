// SPDX-License-Identifier: BSD-3-Clause
#include "igtl/igtl.h"
#include "shared/command_line.h"
#include "shared/named_mesh.h"

namespace keepout::app {

void add_igtl(CLI::App& app, IgtlOptions& options) {
  CLI::App& command = *app.add_subcommand(
      "igtl",
      "Guard a tool over OpenIGTLink, for example for 3D Slicer: take its TRANSFORM, and "
      "send the guarded one");
  igtl::ServerOptions& server = options.server;
  add_mesh(command, options.mesh);
  add_load_options(command, options.load);
  command
      .add_option("--address", server.address,
                  "IPv4 address to listen at; others than 127.0.0.1 let other machines move the "
                  "tool, as there is no authentication")
      ->type_name("ADDRESS")
      ->capture_default_str();
  add_number(command, "--port", server.port, 0, 65535, "Port to listen at; 0: any free one");
  add_number(command, "--rate", server.rate, 10, 2000, "Cycles in a second")->type_name("HZ");
  command
      .add_option("--device", server.device,
                  "Device name of the tool's TRANSFORM; those of other names are refused")
      ->type_name("NAME")
      ->capture_default_str();
  command
      .add_option("--silence", server.longest_silence,
                  "The tool stands still if no TRANSFORM came for this time")
      ->check(number_within(1e-3, 60.0, "a number from 0.001 to 60", "SECONDS"))
      ->capture_default_str();
  command.add_flag_callback(
      "--ignore-stamps", [&server] { server.stamps = igtl::Stamps::ignored; },
      "Count each TRANSFORM as sent when it arrives: for a sender with another clock");
  add_number(command, "--max-body", server.longest_body, 4096, std::uint64_t{1} << 30,
             "Longest body of a message")
      ->type_name("BYTES");
  add_constraint_options(command, server.constraint);
  add_guides(command, options.guides);
  command.final_callback(
      [&options] { options.server.guides = guides_of(options.guides, Guided::tip); });
  command.footer(
      R"(Poses and meshes are in mm, in the frame of the mesh, or in that of the tool after 'register'.

in   TRANSFORM Tool            the pose that the operator wants, at most at --rate
     STRING                    'engage' at the last pose, 'release', 'register'
     POINT Measured, Model     fiducials in the frames of tool and mesh, for 'register'
     POLYDATA                  another mesh, while the tool is released
out  TRANSFORM GuardedTool     the pose that the tool may take, each cycle while engaged
     POLYDATA ActiveTriangles  the triangles that the tool could come too close to in a cycle
     STATUS Keepout            the state of the tool, with its reason
     STATUS KeepoutNote        why a message was refused; a new mesh or registration

The client that sends first controls the tool until it leaves; all others may read, and send
'release'. All of it: docs/slicer.md
)");
}

}  // namespace keepout::app
