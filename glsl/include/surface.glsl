// Texels as places on surfaces: the g-buffer read back, and points within a texel's footprint.
#ifndef SURFACE_GLSL
#define SURFACE_GLSL

#include "scene.glsl"

// (instance + 1 or 0, primitive, barycentrics of the point on the triangle that is nearest to the texel's centre).
layout(set = 0, binding = 8, rgba32ui) readonly uniform uimage2D surface_image;

// A footprint's sides as bytes: -1 to 2 texels from the texel's corner; 0 and 1 are exact.
const uint NO_FOOTPRINT = 0xffffffffu;

vec4 unpack_footprint(uint code) {
    return vec4(uvec4(code, code >> 8u, code >> 16u, code >> 24u) & 255u) / 85.0 - 1.0;
}

uint pack_footprint(vec4 sides) {
    // Rounded inward, so that a side never lies beyond the wall that cut it; a footprint of no width stays one.
    vec4 steps = clamp((sides + 1.0) * 85.0, 0.0, 254.0);
    vec2 low = ceil(steps.xy - 1e-3);
    uvec4 bytes = uvec4(low, max(low, floor(steps.zw + 1e-3)));
    return bytes.x | bytes.y << 8u | bytes.z << 16u | bytes.w << 24u;
}

// A texel's triangle as a plane in world space: point = origin + du * x + dv * y, x and y in texels of the light map
// from the texel's corner.
struct Surface {
    uint instance;
    uint primitive;
    vec3 geometric_normal;  // unit, toward the front
    vec3 normal;            // unit, for shading, on the front side
    vec3 origin;
    vec3 du;
    vec3 dv;
    vec2 barycentric_origin;
    vec2 barycentric_du;
    vec2 barycentric_dv;
    vec2 centre;            // the point of the triangle nearest to the texel's centre
    vec2 start;             // the same, but off the triangle's edge, where a ray could slip past the next wall
};

// Texels from an edge at which a ray may start, and how far into the triangle it starts where it is nearer.
const float EDGE = 0.02;
const float INSET = 0.25;

// `t1`, `t2`: corners 1 and 2 in texels from corner 0; `b`: their barycentrics, and what becomes of them.
vec2 off_the_edge(vec2 t1, vec2 t2, vec2 b) {
    float area = abs(t1.x * t2.y - t1.y * t2.x);
    vec3 heights = area / vec3(length(t2 - t1), length(t2), length(t1));
    vec3 distances = vec3(1.0 - b.x - b.y, b) * heights;
    if (min(distances.x, min(distances.y, distances.z)) >= EDGE) return b;
    vec2 inward = vec2(1.0 / 3.0) - b;
    return b + inward * min(0.5, INSET / max(length(t1 * inward.x + t2 * inward.y), 1e-20));
}

// A texel as a source of light: its plane as above, and the part of it that the bounding rectangle of what lies there leaves.
struct Patch {
    vec3 origin;
    vec3 du;
    vec3 dv;
    vec2 lo;  // texels from the texel's corner, 0 to 1
    vec2 hi;
};

Patch patch_of(uvec2 texel, Piece piece) {
    uint instance = piece.instance, primitive = piece.primitive;
    vec3 v0 = to_world_point(instance, triangles[primitive].corners[0].xyz);
    vec3 e1 = to_world_point(instance, triangles[primitive].corners[1].xyz) - v0;
    vec3 e2 = to_world_point(instance, triangles[primitive].corners[2].xyz) - v0;
    vec2 t0 = corner_texel(instance, primitive, 0u) - vec2(texel);
    vec2 t1 = corner_texel(instance, primitive, 1u) - vec2(texel) - t0;
    vec2 t2 = corner_texel(instance, primitive, 2u) - vec2(texel) - t0;
    float inverse = 1.0 / (t1.x * t2.y - t1.y * t2.x);
    Patch p;
    p.du = (e1 * t2.y - e2 * t1.y) * inverse;
    p.dv = (e2 * t1.x - e1 * t2.x) * inverse;
    p.origin = v0 - p.du * t0.x - p.dv * t0.y;
    p.lo = clamp(t0 + min(vec2(0.0), min(t1, t2)), 0.0, 1.0);
    p.hi = clamp(t0 + max(vec2(0.0), max(t1, t2)), 0.0, 1.0);
    if (SHARED_TEXELS && piece.hi != 0u) {
        p.lo = unpackUnorm2x16(piece.lo);
        p.hi = unpackUnorm2x16(piece.hi);
    }
    return p;
}

// World area, along the normal.
vec3 area_of(Patch p) {
    vec2 sides = p.hi - p.lo;
    return cross(p.du, p.dv) * (sides.x * sides.y);
}

Surface surface_of(uvec2 texel, uvec4 g) {
    Surface s;
    s.instance = g.x - 1u;
    s.primitive = g.y;
    vec2 b = uintBitsToFloat(g.zw);
    vec3 v0 = to_world_point(s.instance, triangles[s.primitive].corners[0].xyz);
    vec3 e1 = to_world_point(s.instance, triangles[s.primitive].corners[1].xyz) - v0;
    vec3 e2 = to_world_point(s.instance, triangles[s.primitive].corners[2].xyz) - v0;
    vec2 t0 = corner_texel(s.instance, s.primitive, 0u);
    vec2 t1 = corner_texel(s.instance, s.primitive, 1u) - t0;
    vec2 t2 = corner_texel(s.instance, s.primitive, 2u) - t0;
    float inverse = 1.0 / (t1.x * t2.y - t1.y * t2.x);
    s.barycentric_du = vec2(t2.y, -t1.y) * inverse;
    s.barycentric_dv = vec2(-t2.x, t1.x) * inverse;
    vec2 corner = vec2(texel) - t0;
    s.barycentric_origin = s.barycentric_du * corner.x + s.barycentric_dv * corner.y;
    s.du = e1 * s.barycentric_du.x + e2 * s.barycentric_du.y;
    s.dv = e1 * s.barycentric_dv.x + e2 * s.barycentric_dv.y;
    s.origin = v0 + e1 * s.barycentric_origin.x + e2 * s.barycentric_origin.y;
    s.centre = t0 + t1 * b.x + t2 * b.y - vec2(texel);
    vec2 inner = off_the_edge(t1, t2, b);
    s.start = t0 + t1 * inner.x + t2 * inner.y - vec2(texel);
    // Of the object's own front: in world space a mirrored transform would turn it round.
    vec3 o0 = triangles[s.primitive].corners[0].xyz;
    vec3 n = cross(triangles[s.primitive].corners[1].xyz - o0, triangles[s.primitive].corners[2].xyz - o0);
    s.geometric_normal = to_world_normal(s.instance, normalize(n / max(abs(n.x), max(abs(n.y), abs(n.z)))));
    vec3 shading = octahedral(primitives[s.primitive].normals[0]) * (1.0 - b.x - b.y)
                   + octahedral(primitives[s.primitive].normals[1]) * b.x
                   + octahedral(primitives[s.primitive].normals[2]) * b.y;
    shading = dot(shading, shading) > 1e-6 ? to_world_normal(s.instance, normalize(shading)) : s.geometric_normal;
    s.normal = dot(shading, s.geometric_normal) > 0.0 ? shading : s.geometric_normal;
    return s;
}

vec3 point_at(Surface s, vec2 texel) {
    return s.origin + s.du * texel.x + s.dv * texel.y;
}

bool on_triangle(Surface s, vec2 texel) {
    vec2 b = s.barycentric_origin + s.barycentric_du * texel.x + s.barycentric_dv * texel.y;
    return b.x >= 0.0 && b.y >= 0.0 && b.x + b.y <= 1.0;
}

#endif
