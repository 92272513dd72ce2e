// SPDX-License-Identifier: GPL-3.0-or-later
#include "scale/setting.h"

#include <cmath>

#include <gtest/gtest.h>

#include "gate.h"
#include "scale/find_scale.h"
#include "shapes.h"

namespace isograft {
namespace {

double scale_found(const shapes::Shape& source, const shapes::Shape& target) {
    MatchOptions options;
    MatchReport report;
    Monitor monitor;
    return prepare_pair(gate(source), gate(target), options, report, monitor, 0.0, 1.0).setting.scale;
}

const shapes::Shape& body() {
    static const shapes::Shape shape = shapes::blob(3);
    return shape;
}

/// The body, turned, with holes all over it.
const shapes::Shape& ragged() {
    static const shapes::Shape shape = shapes::moved(
        shapes::cut(body(),
                    [](const Eigen::Vector3d& x) {
                        return std::sin(13.0 * x.x()) * std::sin(13.0 * x.y() + 1.0) + std::sin(13.0 * x.z()) < 1.1;
                    }),
        shapes::some_rotation(), {1, 2, 3});
    return shape;
}

TEST(Setting, FindsACommonUnitEitherWayWhereVotesOfTheWholeGoAstray) {
    Monitor monitor;
    const ScaleVotes astray = vote_scale(gate(body()).mesh(), gate(ragged()).mesh(), {}, {}, 4, 2, monitor, 0.0, 1.0);
    ASSERT_GT(std::abs(std::log(astray.by_fit)), 0.5);
    EXPECT_DOUBLE_EQ(scale_found(ragged(), body()), 1.0);
    EXPECT_DOUBLE_EQ(scale_found(body(), ragged()), 1.0);
}

}  // namespace
}  // namespace isograft
