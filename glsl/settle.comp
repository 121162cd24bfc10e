#version 460
// Settles where in each texel rays may start: its footprint is cut off at walls that stand in it, its centre is moved
// out of a wall that it lies in, and a texel that lies inside an object is given up. By geometry alone, once.
#extension GL_GOOGLE_include_directive : require
#include "include/rays.glsl"
#include "include/random.glsl"
#include "include/sampling.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 9, r32ui) uniform uimage2D footprint_image;

// How far a footprint stays away from a wall, as a share of the way to it.
const float CLEARANCE = 0.95;
// Walls are looked for a little beyond the way, so that one at its very end, as at many a texel's border, is always found
// and not as rounding would have it.
const float BEYOND = 1.1;
// Sides of the grids of rays that decide whether a texel is inside an object: few rays, and more where one of them saw a
// back face.
const uint FEW_SIDE = 2u;
const uint MANY_SIDE = 5u;

bool shows_back(Hit hit) {
    return hit.committed && !hit.front_face
           && (primitives[hit.primitive].flags & PRIMITIVE_DOUBLE_SIDED) == 0u;
}

// A ray along the surface from `from` by `way` texels; t is in parts of the way.
Hit look_along(Surface s, vec2 from, vec2 way) {
    return trace_closest(ray_from(s, point_at(s, from), s.du * way.x + s.dv * way.y, BEYOND));
}

// Past the nearest back face within a texel: the centre lies in a wall.
vec2 move_out(Surface s, vec2 centre) {
    float nearest = 1.0;
    vec2 moved = centre;
    for (uint i = 0u; i < 8u; ++i) {
        vec2 way = vec2(cos(float(i) * PI / 4.0), sin(float(i) * PI / 4.0));
        Hit hit = look_along(s, centre, way);
        vec2 beyond = centre + way * (hit.t * 1.05 + 0.01);
        if (shows_back(hit) && hit.t < nearest && on_triangle(s, beyond)) {
            nearest = hit.t;
            moved = beyond;
        }
    }
    return moved;
}

// How much of `way` from the centre is free, as the coordinate that is reached.
float reach(Surface s, vec2 centre, vec2 way) {
    Hit hit = look_along(s, centre, way);
    return hit.committed ? min(1.0, hit.t * CLEARANCE) : 1.0;
}

// Share of back faces over the hemisphere.
float back_share(Surface s, uint key, uint side) {
    mat3 frame = frame_of(s.geometric_normal);
    uint count = 0u;
    for (uint i = 0u; i < side * side; ++i) {
        vec3 direction = frame * cosine_direction(stratified(i, side * side, random4(key, i, side).xy));
        count += uint(shows_back(trace_closest(ray_from(s, point_at(s, s.start), direction, 1e30))));
    }
    return float(count) / float(side * side);
}

void main() {
    uvec2 texel = gl_GlobalInvocationID.xy + uvec2(0u, push.first_texel);
    if (any(greaterThanEqual(texel, push.map_size))) return;
    uvec4 g = imageLoad(surface_image, ivec2(texel));
    if (g.x == 0u) {
        imageStore(footprint_image, ivec2(texel), uvec4(NO_FOOTPRINT));
        return;
    }
    Surface s = surface_of(texel, g);
    // What may move is not judged by where it happens to be.
    if ((instances[s.instance].flags & INSTANCE_MOVABLE) != 0u) {
        vec4 all = vec4(min(vec2(0.0), s.start), max(vec2(1.0), s.start));
        imageStore(footprint_image, ivec2(texel), uvec4(pack_footprint(all)));
        return;
    }
    if (SINGLE_SIDED) {
        s.start = move_out(s, s.start);
        uint key = texel.x | texel.y << 16u;
        if (back_share(s, key, FEW_SIDE) > 0.0 && back_share(s, key, MANY_SIDE) > 0.5) {
            imageStore(footprint_image, ivec2(texel), uvec4(NO_FOOTPRINT));
            return;
        }
    }
    vec2 lo = min(vec2(0.0), s.start), hi = max(vec2(1.0), s.start);
    vec4 way = vec4(lo - s.start, hi - s.start);
    vec4 sides;
    sides.x = s.start.x + way.x * reach(s, s.start, vec2(way.x, 0.0));
    sides.y = s.start.y + way.y * reach(s, s.start, vec2(0.0, way.y));
    sides.z = s.start.x + way.z * reach(s, s.start, vec2(way.z, 0.0));
    sides.w = s.start.y + way.w * reach(s, s.start, vec2(0.0, way.w));
    imageStore(footprint_image, ivec2(texel), uvec4(pack_footprint(sides)));
}
