// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/distance_fields.h"

#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "shapes.h"
#include "twins.h"

namespace isograft {
namespace {

TEST(DistanceFields, HoldWhatWindowsMeasure) {
    const Pair& pair = Twins::of_a_blob().pair();
    DistanceFields fields(pair);
    Window on_source(pair.source.mesh), on_target(pair.target.mesh), check_source(pair.source.mesh),
        check_target(pair.target.mesh);
    constexpr double everywhere = std::numeric_limits<double>::infinity();
    const auto samples = fields.from_sample(7, on_source);
    check_source.run(pair.source.samples.point[7], everywhere);
    for (int s = 0; s < pair.source.samples.count(); s += 3) {
        EXPECT_EQ(samples->distance[s], static_cast<float>(check_source.query(pair.source.samples.point[s])->distance));
        EXPECT_EQ(samples->sight[s], Sight::straight);
    }
    const auto vertices = fields.from_vertex(11, on_target);
    check_target.run(point_near_vertex(pair.target.mesh, 11), everywhere);
    for (int v = 0; v < pair.target.mesh.vertex_count(); v += 3) {
        EXPECT_EQ(vertices->distance[v], static_cast<float>(check_target.distance(v)));
        EXPECT_EQ(vertices->departure[v], static_cast<float>(check_target.angle(v)));
    }
}

TEST(DistanceFields, AreMeasuredOnceForEveryThread) {
    const Pair& pair = Twins::of_a_blob().pair();
    DistanceFields fields(pair);
    using Asked = std::vector<std::shared_ptr<const DistanceField>>;
    Asked first(20), second(20);
    const auto ask = [&](Asked& answers) {
        Window on_source(pair.source.mesh), on_target(pair.target.mesh);
        for (int i = 0; i < 20; ++i) {
            answers[i] = i % 2 == 0 ? fields.from_sample(i % 10, on_source) : fields.from_vertex(i % 10, on_target);
        }
    };
    std::thread other(ask, std::ref(first));
    ask(second);
    other.join();
    EXPECT_EQ(first, second);
    for (int i = 0; i < 10; ++i) EXPECT_EQ(first[i], first[i + 10]);
}

TEST(DistanceFields, LeaveOutWhatCannotBeReached) {
    const shapes::Shape one = shapes::grid(8, 8, 0.1, 0.1);
    const Eigen::Matrix3d same = Eigen::Matrix3d::Identity();
    const Twins twins(shapes::joined(one, shapes::moved(one, same, {5.0, 0.0, 0.0})));
    DistanceFields fields(twins.pair());
    Window window(twins.pair().target.mesh);
    const auto field = fields.from_vertex(0, window);
    const int count = twins.pair().target.mesh.vertex_count();
    int reached = 0;
    for (int v = 0; v < count; ++v) reached += field->sight[v] == Sight::none ? 0 : 1;
    EXPECT_EQ(2 * reached, count);
}

}  // namespace
}  // namespace isograft
