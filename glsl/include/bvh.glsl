// Traversal of the host-built hierarchy; src/bvh/traverse.rs is its twin on the host.
#ifndef BVH_GLSL
#define BVH_GLSL

#include "scene.glsl"

layout(set = 0, binding = 0, std430) readonly buffer Nodes { Node nodes[]; };

// The buffers of nodes and of triangles once more, as texels of four words.
layout(set = 0, binding = 43) uniform usamplerBuffer node_texels;
layout(set = 0, binding = 15) uniform usamplerBuffer triangle_texels;

const uint LEAF = 0x80000000u;
const uint LEAF_FIRST = 0x03ffffffu;

// What traversal knows of a ray in the space of the level it is in.
struct Slope {
    vec3 origin;
    vec3 inverse;         // of the direction
    vec3 origin_inverse;  // -origin * inverse
    vec3 row_x;           // shear of Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013,
    vec3 row_y;           // as rows, so that no component is chosen at run time
    vec3 row_z;
};

Slope slope_of(vec3 origin, vec3 direction) {
    Slope s;
    s.origin = origin;
    // A zero component counts as a tiny one: 1/0 would bring NaN where the origin lies in a slab's plane.
    vec3 away = mix(vec3(-1e-20), vec3(1e-20), greaterThanEqual(direction, vec3(0.0)));
    s.inverse = 1.0 / mix(direction, away, lessThan(abs(direction), vec3(1e-20)));
    s.origin_inverse = -origin * s.inverse;
    vec3 d = abs(direction);
    bool z = d.z >= d.x && d.z >= d.y;
    bool y = !z && d.y >= d.x;
    vec3 axis = z ? vec3(0, 0, 1) : y ? vec3(0, 1, 0) : vec3(1, 0, 0);
    vec3 next = z ? vec3(1, 0, 0) : y ? vec3(0, 0, 1) : vec3(0, 1, 0);
    vec3 last = z ? vec3(0, 1, 0) : y ? vec3(1, 0, 0) : vec3(0, 0, 1);
    float scale = 1.0 / dot(axis, direction);
    s.row_x = next - axis * (dot(next, direction) * scale);
    s.row_y = last - axis * (dot(last, direction) * scale);
    s.row_z = axis * scale;
    return s;
}

Node node_at(uint index) {
    if (!TEXEL_BUFFERS) return nodes[index];
    int first = int(index) * 4;
    return Node(texelFetch(node_texels, first), texelFetch(node_texels, first + 1), texelFetch(node_texels, first + 2),
                texelFetch(node_texels, first + 3));
}

vec3 corner_of(uint primitive, int corner) {
    if (!TEXEL_BUFFERS) return triangles[primitive].corners[corner].xyz;
    return uintBitsToFloat(texelFetch(triangle_texels, int(primitive) * 3 + corner).xyz);
}

// Ize, "Robust BVH Ray Traversal", JCGT 2(2), 2013.
const float FAR_SLACK = 1.0000004;

// Where a ray is in a box: enter <= leave, or nowhere.
struct Range {
    float enter;
    float leave;
};

// Floats are compared as integers, which have the order of those over 0. Those below 0 lie before t_min: whichever of
// them is taken, the result is below 0 as well. Lavapipe takes three instructions for a min of floats, and one for this.
Range intersect_box(Slope s, uvec3 lo, uvec3 hi, float t_min, float t_max) {
    ivec3 t_lo = floatBitsToInt(fma(uintBitsToFloat(lo), s.inverse, s.origin_inverse));
    ivec3 t_hi = floatBitsToInt(fma(uintBitsToFloat(hi), s.inverse, s.origin_inverse));
    ivec3 near = min(t_lo, t_hi);
    ivec3 far = max(t_lo, t_hi);
    int enter = max(max(near.x, near.y), max(near.z, floatBitsToInt(t_min)));
    int leave = min(min(far.x, far.y), min(far.z, floatBitsToInt(t_max)));
    return Range(intBitsToFloat(enter), intBitsToFloat(leave) * FAR_SLACK);
}

struct Candidate {
    bool hit;
    float t;
    vec2 barycentrics;
    bool front_face;
};

// Hits between t_min and t_max, both left out. No branches; edge functions are exactly antisymmetric in their corners,
// so that a ray through a shared edge always hits one of the two triangles.
Candidate intersect_triangle(Slope s, uint primitive, float t_min, float t_max) {
    vec3 a = corner_of(primitive, 0) - s.origin;
    vec3 b = corner_of(primitive, 1) - s.origin;
    vec3 c = corner_of(primitive, 2) - s.origin;
    precise vec2 pa = vec2(dot(s.row_x, a), dot(s.row_y, a));
    precise vec2 pb = vec2(dot(s.row_x, b), dot(s.row_y, b));
    precise vec2 pc = vec2(dot(s.row_x, c), dot(s.row_y, c));
    precise float u = pc.x * pb.y - pc.y * pb.x;
    precise float v = pa.x * pc.y - pa.y * pc.x;
    precise float w = pb.x * pa.y - pb.y * pa.x;
    bool inside = u >= 0.0 && v >= 0.0 && w >= 0.0 || u <= 0.0 && v <= 0.0 && w <= 0.0;
    float det = u + v + w;
    float inverse = 1.0 / det;
    Candidate hit;
    hit.t = (u * dot(s.row_z, a) + v * dot(s.row_z, b) + w * dot(s.row_z, c)) * inverse;
    hit.hit = inside && det != 0.0 && hit.t > t_min && hit.t < t_max;
    hit.barycentrics = vec2(v, w) * inverse;
    // The axes keep their cyclic order, so that only the ray's way along its main axis turns the winding round.
    hit.front_face = (det > 0.0) == (s.row_z.x + s.row_z.y + s.row_z.z > 0.0);
    return hit;
}

#endif
