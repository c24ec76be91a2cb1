// A seated figure in meditation on a lotus throne. Every part is a sock of rings whose points are found on a sculpted
// distance function by rays from the part's spine; the parts run into each other, and the voxels of a volume take their
// union. Millimetres here, metres in the mesh. The viewer stands at -y.

#include "surface/shape_builder.h"
#include "surface/shape_makers.h"
#include "surface/statuette_body.h"
#include "surface/statuette_head.h"
#include "surface/statuette_throne.h"

#include <cmath>

namespace patina {

using namespace statuette;

namespace {

constexpr double millimetre = 0.001;
constexpr double seatHeight = 54.0; ///< of the throne
constexpr double headSize = 1.1;

/// Where the rays of one row of a part start and how they fan out: from `centre` + spread * ring, in the plane of x and
/// y, raised towards the axis x × y by `elevation`.
struct Ring {
    V3d centre;
    V3d x{1, 0, 0}, y{0, 1, 0};
    V2d spread{0, 0};
    double elevation = 0.0;
};

/// Adds a part of `body`: `ringAt(t)` for t from 0 (first row) to 1.
void addPart(ShapeBuilder& builder, Sock sock, const Body& body, const std::function<Ring(double)>& ringAt,
             double farthest, const std::function<V3d(const V3d&)>& toWorld) {
    const auto cast = [&](const Ring& ring, const V2d& around, double share, double elevation) {
        const V3d plane = ring.x * around.x + ring.y * around.y;
        const V3d origin =
            ring.centre + ring.x * (around.x * ring.spread.x * share) + ring.y * (around.y * ring.spread.y * share);
        const V3d direction = plane * std::cos(elevation) + ring.x.cross(ring.y) * std::sin(elevation);
        return toWorld(outermost(body, origin, direction, farthest, 0.5)) * millimetre;
    };
    const auto cap = [&](const V2d& disc, const Ring& ring, double pole) {
        const double r = disc.length();
        return cast(ring, r > 1e-9 ? disc / r : V2d(0, -1), r, pole + r * (ring.elevation - pole));
    };
    sock.side = [&](V2d around, int, int row) {
        const Ring ring = ringAt(double(row) / sock.rows);
        return cast(ring, around, 1.0, ring.elevation);
    };
    const Ring first = ringAt(0.0), last = ringAt(1.0);
    sock.below = [&](V2d disc) { return cap(disc, first, -0.5 * M_PI); };
    sock.above = [&](V2d disc) { return cap(disc, last, 0.5 * M_PI); };
    builder.addSock(sock);
}

Sock sockOf(int across, int along, int rows, double density = 1.0) {
    Sock sock;
    sock.across = across;
    sock.along = along;
    sock.rows = rows;
    sock.density = density;
    return sock;
}

/// The head looks down a little. Head space has y to the front.
V3d headToFigure(const V3d& p) {
    const double tilt = 0.10;
    const V3d q(p.x, -p.y, p.z);
    return V3d(q.x, q.y * std::cos(tilt) - q.z * std::sin(tilt), q.y * std::sin(tilt) + q.z * std::cos(tilt)) *
               headSize +
           headCentre;
}

V3d onSeat(const V3d& p) {
    return p + V3d(0, 0, seatHeight);
}

void addHead(ShapeBuilder& builder) {
    const Head head;
    const Body body = [&](const V3d& p) { return head(V3d(p.x, -p.y, p.z)); };
    // Rays start higher the higher they point, so that they meet the topknot squarely.
    addPart(
        builder, sockOf(52, 38, 70, 1.5), body,
        [](double t) {
            Ring ring;
            ring.elevation = mix(-1.0, 0.72, t);
            const double up = smoothstep(0.6, 1.0, t);
            ring.centre = V3d(0, 3.5 * up, 13 * up);
            return ring;
        },
        46.0, [](const V3d& p) { return onSeat(headToFigure(V3d(p.x, -p.y, p.z))); });
}

void addEar(ShapeBuilder& builder, double side) {
    // Turned a little to the front, in head space with y to the back: forward, up and outward.
    const double turn = 0.35;
    const V3d outward(side * std::cos(turn), -std::sin(turn), 0.0), up(0, 0, 1);
    const V3d x = up.cross(outward);
    const V3d foot(side * 19.0, 2.5, -3.0);
    const V2d middle(-0.6, -1.5);
    Sock sock = sockOf(14, 30, 5, 1.5);
    const auto place = [&](V2d disc, double depth) {
        const double r = disc.length();
        const V2d toEdge = r > 1e-9 ? disc / r : V2d(0, -1);
        const V3d direction = V3d(toEdge.x * 5.0, toEdge.y * 12.0, 0).normalized();
        const V3d start(middle.x, middle.y, 0);
        const V3d edge = outermost([](const V3d& p) { return earOutline(p.x, p.y); }, start, direction, 22.0, 1.0);
        const V3d at = start + (edge - start) * r; // forward, up
        const double back = mix(-2.0, -6.0, smoothstep(-8, -2, at.y));
        const double height = depth < 0 ? back : mix(back, earRelief(at.x, at.y) * std::min(1.0, depth), depth);
        const V3d p = foot + x * (-side * at.x) + up * at.y + outward * height;
        return onSeat(headToFigure(V3d(p.x, -p.y, p.z))) * millimetre;
    };
    // The relief's x runs forward, the sock's to the back on the right ear: mirrored there.
    const auto mirrored = [&](V2d v) { return V2d(-side * v.x, v.y); };
    sock.side = [&](V2d ring, int, int row) { return place(mirrored(ring), double(row) / sock.rows); };
    sock.below = [&](V2d disc) { return place(mirrored(disc), -1.0); };
    sock.above = [&](V2d disc) { return place(mirrored(disc), 1.0); };
    builder.addSock(sock);
}

void addNeck(ShapeBuilder& builder) {
    addPart(
        builder, sockOf(12, 12, 24), neckBody,
        [](double t) {
            Ring ring;
            ring.centre = mix(V3d(0, 4, 112), V3d(0, 0, 146), t);
            return ring;
        },
        40.0, onSeat);
}

void addTorso(ShapeBuilder& builder) {
    addPart(
        builder, sockOf(46, 34, 76), torsoBody,
        [](double t) {
            Ring ring;
            const double z = mix(0, 128, t);
            ring.centre = V3d(0, 5, std::min(z, 96.0));
            ring.elevation = z > 84.0 ? (z - 84.0) / 44.0 * 1.15 : 0.0;
            ring.spread = V2d(24.0 * smoothstep(40, 90, z), 0.0);
            return ring;
        },
        110.0, onSeat);
}

void addSleeve(ShapeBuilder& builder, double side) {
    const Body body = [side](const V3d& p) { return sleeveBody(V3d(side * p.x, p.y, p.z), side); };
    addPart(
        builder, sockOf(14, 14, 44), body,
        [side](double t) {
            const V3d from(side * elbow.x, elbow.y, elbow.z), to(side * cuff.x, cuff.y, cuff.z);
            const V3d axis = (to - from).normalized();
            Ring ring;
            ring.centre = mix(from, to, smoothstep(0.05, 1.0, t) * 0.92);
            ring.x = V3d(0, 0, 1).cross(axis).normalized();
            ring.y = axis.cross(ring.x);
            ring.elevation = t < 0.2 ? -0.9 * (1.0 - t / 0.2) : t > 0.8 ? 0.7 * (t - 0.8) / 0.2 : 0.0;
            return ring;
        },
        48.0, onSeat);
}

void addLap(ShapeBuilder& builder) {
    addPart(
        builder, sockOf(60, 26, 32), lapBody,
        [](double t) {
            Ring ring;
            ring.centre = V3d(0, -10, 8);
            ring.spread = V2d(48, 18);
            ring.elevation = mix(-0.5, 1.25, t);
            return ring;
        },
        110.0, onSeat);
}

/// A finger: a tube around the middle line `at`.
void addFinger(ShapeBuilder& builder, double side, const Body& body, const std::function<V3d(double)>& at) {
    const auto mirrored = [side](V3d p) {
        p.x *= side;
        return p;
    };
    addPart(
        builder, sockOf(4, 4, 14, 1.2), [&](const V3d& p) { return body(mirrored(p)); },
        [&](double t) {
            const V3d axis = (mirrored(at(t + 0.02)) - mirrored(at(t - 0.02))).normalized();
            Ring ring;
            ring.centre = mirrored(at(t));
            ring.x = V3d(0, -1, 0).cross(axis).normalized();
            ring.y = axis.cross(ring.x);
            ring.elevation = 0.7 * smoothstep(0.75, 1.0, t);
            return ring;
        },
        9.0, onSeat);
}

void addHand(ShapeBuilder& builder, double side) {
    const Hand hand{side < 0};
    const Body palm = [&](const V3d& p) { return hand.palm(V3d(side * p.x, p.y, p.z)); };
    addPart(
        builder, sockOf(14, 14, 20, 1.2), palm,
        [&](double t) {
            // From the wrist to the knuckles.
            V3d from(33, -28, 43), to = (hand.knuckle(1) + hand.knuckle(2)) * 0.5 + V3d(2, 0, 0);
            from.x *= side;
            to.x *= side;
            const V3d axis = (to - from).normalized();
            Ring ring;
            ring.centre = mix(from, to, t);
            ring.x = V3d(0, 0, 1).cross(axis).normalized();
            ring.y = axis.cross(ring.x);
            ring.spread = V2d(6.0 * t, 0.0);
            ring.elevation = mix(-0.4, 0.7, t);
            return ring;
        },
        30.0, onSeat);
    for (int i = 0; i < 4; ++i)
        addFinger(
            builder, side, [&](const V3d& p) { return hand.finger(i, p); },
            [&](double t) { return hand.fingerAt(i, t); });
    addFinger(
        builder, side, [&](const V3d& p) { return hand.thumb(p); }, [&](double t) { return hand.thumbAt(t); });
}

void addThrone(ShapeBuilder& builder) {
    const Throne throne(seatHeight);
    constexpr int perSide = petalCount * columnsPerPetal / 4;
    Sock sock = sockOf(perSide, perSide, throne.rows());
    sock.side = [&](V2d, int column, int row) { return throne.at(column, row) * millimetre; };
    const auto patch = [&](V2d disc, int row) {
        const double turn = (std::atan2(disc.y, disc.x) + 0.75 * M_PI) / (2 * M_PI); // 0 at the front's left corner
        return throne.inside(turn, disc.length(), row) * millimetre;
    };
    sock.below = [&](V2d disc) { return patch(disc, 0); };
    sock.above = [&](V2d disc) { return patch(disc, sock.rows); };
    builder.addSock(sock);
}

} // namespace

Mesh makeStatuette() {
    ShapeBuilder builder("statuette");
    addHead(builder);
    for (const double side : {-1.0, 1.0}) {
        addEar(builder, side);
        addSleeve(builder, side);
        addHand(builder, side);
    }
    addNeck(builder);
    addTorso(builder);
    addLap(builder);
    addThrone(builder);
    builder.interpolateLimit(2);
    return builder.finish();
}

} // namespace patina
