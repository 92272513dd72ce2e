// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "isograft/surface.h"
#include "shapes.h"

namespace isograft {

/// The shape through the gate.
Surface gate(const shapes::Shape& shape);

/// Whether some warning holds the text.
bool warns(const Surface& surface, const std::string& text);

/// What the gate says when it refuses the shape; empty if it does not.
std::string refusal(const shapes::Shape& shape);

/// Signed volume about the origin.
double volume(const TriangleMesh& mesh);

/// Expect every half-edge's twin to run the other way between the same vertices, and every vertex to have one fan.
void expect_manifold(const TriangleMesh& mesh);

/// Expect the working triangles to be the input's, corner by corner.
void expect_indexed_by_input(const Surface& surface);

}  // namespace isograft
