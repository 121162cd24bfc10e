#version 460
// Light-map-space g-buffer: a texel that a triangle touches gets the triangle's point nearest to its centre. The depth
// test keeps the nearest triangle, so that one which holds the centre wins over one which only touches.
// All in object space: a moved object is not drawn again.
#extension GL_GOOGLE_include_directive : require
#include "include/layout.glsl"
#include "include/scene.glsl"

layout(set = 0, binding = 13) uniform sampler2D albedo_texture;
layout(set = 0, binding = 14) uniform sampler2D emission_texture;
layout(set = 0, binding = 15, std430) readonly buffer Texture_coordinates { Texcoords texcoords[]; };

layout(location = 0) flat in uint in_primitive;
layout(location = 1) flat in vec2 in_t0;
layout(location = 2) flat in vec2 in_t1;
layout(location = 3) flat in vec2 in_t2;

layout(location = 0) out uvec4 out_surface;
layout(location = 1) out vec4 out_albedo;
layout(location = 2) out vec4 out_emission;

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

void main() {
    vec2 centre = floor(gl_FragCoord.xy) + 0.5;
    float area = cross2(in_t1 - in_t0, in_t2 - in_t0);
    float winding = area < 0.0 ? -1.0 : 1.0;
    vec2 lo = min(in_t0, min(in_t1, in_t2)) - TOUCH - 0.5;
    vec2 hi = max(in_t0, max(in_t1, in_t2)) + TOUCH + 0.5;
    // As far as the cleared depth and as empty: leaves all as it is, and needs no feature as a discard would (demotion).
    gl_FragDepth = 1.0;
    out_surface = uvec4(0u);
    out_albedo = out_emission = vec4(0.0);
    if (area == 0.0 || any(lessThan(centre, lo)) || any(greaterThan(centre, hi))) return;
    if (outside(in_t0, in_t1, centre, winding) || outside(in_t1, in_t2, centre, winding)
        || outside(in_t2, in_t0, centre, winding)) return;
    vec2 b = nearest_point(centre, area);
    vec2 point = in_t0 + (in_t1 - in_t0) * b.x + (in_t2 - in_t0) * b.y;
    gl_FragDepth = min(distance(point, centre), 0.999);
    out_surface = uvec4(push.instance + 1u, in_primitive, floatBitsToUint(b));
    Material material = materials[primitives[in_primitive].material];
    vec3 albedo = material.albedo;
    // The material's own factor is applied where the map is read: it may change.
    vec3 emission = vec3(1.0);
    if (TEXTURES) {
        // The texel's own extent in the texture, so that the mip level is the texel's mean.
        vec2 bx = vec2(in_t2.y - in_t0.y, in_t0.y - in_t1.y) / area;
        vec2 by = vec2(in_t0.x - in_t2.x, in_t1.x - in_t0.x) / area;
        Texcoords uv = texcoords[in_primitive];
        vec2 a1 = uv.albedo[1] - uv.albedo[0], a2 = uv.albedo[2] - uv.albedo[0];
        vec2 m1 = uv.emission[1] - uv.emission[0], m2 = uv.emission[2] - uv.emission[0];
        albedo *= textureGrad(albedo_texture, uv.albedo[0] + a1 * b.x + a2 * b.y, a1 * bx.x + a2 * bx.y,
                              a1 * by.x + a2 * by.y).rgb;
        emission = textureGrad(emission_texture, uv.emission[0] + m1 * b.x + m2 * b.y, m1 * bx.x + m2 * bx.y,
                                m1 * by.x + m2 * by.y).rgb;
    }
    out_albedo = vec4(albedo, 1.0);
    out_emission = vec4(emission, 1.0);
}
