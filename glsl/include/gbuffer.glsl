// A triangle of the g-buffer in its texel: which point of it the texel is, if any.
#ifndef GBUFFER_GLSL
#define GBUFFER_GLSL

#include "scene.glsl"

layout(location = 0) flat in uint in_primitive;
layout(location = 1) flat in vec2 in_t0;
layout(location = 2) flat in vec2 in_t1;
layout(location = 3) flat in vec2 in_t2;

// A hit's light-map coordinate may round across a texel's border: touching is counted from this far, in texels.
const float TOUCH = 0.002;

float cross2(vec2 a, vec2 b) {
    return a.x * b.y - a.y * b.x;
}

// Whether an edge's line keeps the whole texel on its outer side. `winding`: 1 or -1.
bool outside(vec2 from, vec2 to, vec2 centre, float winding) {
    vec2 edge = to - from;
    float reach = (0.5 + TOUCH) * (abs(edge.x) + abs(edge.y));
    return cross2(edge, centre - from) * winding < -reach;
}

// Parameter along an edge of the point nearest to `p`.
float nearest_on(vec2 from, vec2 to, vec2 p) {
    vec2 edge = to - from;
    return clamp(dot(p - from, edge) / max(dot(edge, edge), 1e-30), 0.0, 1.0);
}

// Barycentrics of corners 1 and 2 of the triangle's point nearest to `p`.
vec2 nearest_point(vec2 p, float area) {
    vec2 b = vec2(cross2(p - in_t0, in_t2 - in_t0), cross2(in_t1 - in_t0, p - in_t0)) / area;
    if (b.x >= 0.0 && b.y >= 0.0 && b.x + b.y <= 1.0) return b;
    float s01 = nearest_on(in_t0, in_t1, p), s02 = nearest_on(in_t0, in_t2, p), s12 = nearest_on(in_t1, in_t2, p);
    float d01 = distance(p, mix(in_t0, in_t1, s01));
    float d02 = distance(p, mix(in_t0, in_t2, s02));
    float d12 = distance(p, mix(in_t1, in_t2, s12));
    if (d01 <= d02 && d01 <= d12) return vec2(s01, 0.0);
    if (d02 <= d12) return vec2(0.0, s02);
    return vec2(1.0 - s12, s12);
}

// The point of the triangle that the texel is.
struct Drawn {
    bool touches;
    // Of corners 1 and 2.
    vec2 barycentrics;
    // Twice the triangle's, in texels, with its winding's sign.
    float area;
    float depth;
};

// What is not touched is as far as the cleared depth and as empty: it leaves all as it is, and needs no feature as a discard
// would (demotion).
Drawn draw() {
    vec2 centre = floor(gl_FragCoord.xy) + 0.5;
    float area = cross2(in_t1 - in_t0, in_t2 - in_t0);
    float winding = area < 0.0 ? -1.0 : 1.0;
    vec2 lo = min(in_t0, min(in_t1, in_t2)) - TOUCH - 0.5;
    vec2 hi = max(in_t0, max(in_t1, in_t2)) + TOUCH + 0.5;
    Drawn nowhere = Drawn(false, vec2(0.0), area, 1.0);
    if (area == 0.0 || any(lessThan(centre, lo)) || any(greaterThan(centre, hi))) return nowhere;
    if (outside(in_t0, in_t1, centre, winding) || outside(in_t1, in_t2, centre, winding)
        || outside(in_t2, in_t0, centre, winding)) return nowhere;
    vec2 b = nearest_point(centre, area);
    vec2 point = in_t0 + (in_t1 - in_t0) * b.x + (in_t2 - in_t0) * b.y;
    return Drawn(true, b, area, min(distance(point, centre), 0.999));
}

uvec4 surface_of(Drawn drawn) {
    return drawn.touches ? uvec4(push.instance + 1u, in_primitive, floatBitsToUint(drawn.barycentrics)) : uvec4(0u);
}

#endif
