#version 460
// Pyramids of 2 x 2 sums that rays are aimed by: over the texels of the light map, luminance of the source times world
// area, and over the pixels of the sky map, luminance times solid angle. Level 0 also sums up what decides how many rays
// are aimed.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "include/layout.glsl"
#include "include/pieces.glsl"
#include "include/random.glsl"
#include "include/pyramid.glsl"
#include "include/sky.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 10) uniform texture2D source_map;
layout(set = 0, binding = 18, rgba32f) readonly uniform image2D emission_image;
layout(set = 0, binding = 28, rgba32f) coherent uniform image2D pyramid_image;
layout(set = 0, binding = 29, rgba32f) readonly uniform image2D evidence_image;
layout(set = 0, binding = 30, rgba32f) readonly uniform image2D sky_evidence_image;
// What rays are aimed by: see aimed_luminance.
layout(set = 0, binding = 33, r32f) writeonly uniform image2D aimed_luminance_image;
// A work group's sums, of level 0: (leaves, luminance squared times area, area, texels whose source is no light), the
// evidence, and that of the sky.
layout(set = 0, binding = 20, std430) writeonly buffer Sums { vec4 sums[]; };

// No leaf is larger, so that no sum of 2^28 of them is beyond 32-bit floats.
const float MOST = 1e30;
// Less loses bits, and is no longer what its density says.
const float LEAST = 1e-36;

shared vec4 group[64][3];

uvec2 leaves() {
    return push.instance == 0u ? push.map_size : uvec2(textureSize(sky_map, 0));
}

float luminance_of(vec3 radiance) {
    return dot(radiance, vec3(0.2126, 0.7152, 0.0722));
}

float sky_leaf(uvec2 pixel) {
    return luminance_of(texelFetch(sky_map, ivec2(pixel), 0).rgb) * sky_solid_angle(pixel.y, leaves());
}

// Mean luminance over the pieces of what they emit, which in a dynamic scene the source map does not hold.
float emitted(ivec2 texel, Shared s, float area) {
    vec3 colour = EMISSION_TEXTURES ? imageLoad(emission_image, texel).rgb : vec3(1.0);
    float sum = 0.0;
    for (uint i = 0u; i < s.count; ++i) {
        Piece piece = piece_at(s, i);
        if (!is_present(piece)) continue;
        Patch p = patch_of(uvec2(texel), piece);
        sum += luminance_of(materials[primitives[piece.primitive].material].emission * colour) * length(area_of(p));
    }
    return area > 0.0 ? sum / area : 0.0;
}

// Luminance times area; adds to this invocation's sums.
float source_leaf(ivec2 texel, inout vec4 mine[3]) {
    uvec4 g = imageLoad(surface_image, texel);
    if (g.x == 0u) return 0.0;
    Shared s = pieces_of(uvec2(texel), g);
    float area = area_of_pieces(uvec2(texel), s);
    float luminance = luminance_of(texelFetch(source_map, texel, 0).rgb) + (DYNAMIC ? emitted(texel, s, area) : 0.0);
    float leaf = luminance * area;
    // Written so that what is no number fails.
    bool is_light = leaf >= 0.0 && leaf <= 3.4e38;
    if (!is_light || leaf < LEAST) leaf = 0.0;
    leaf = min(leaf, MOST);
    imageStore(aimed_luminance_image, texel, vec4(aimed_luminance(leaf, area)));
    mine[0] += vec4(leaf, leaf * luminance, area, is_light ? 0.0 : 1.0);
    mine[1] += imageLoad(evidence_image, texel);
    if (SKY_MAP) mine[2] += imageLoad(sky_evidence_image, texel);
    return leaf;
}

// The four leaves of a texel of level 0.
vec4 leaves_at(uvec2 at, inout vec4 mine[3]) {
    vec4 four = vec4(0.0);
    for (uint i = 0u; i < 4u; ++i) {
        uvec2 leaf = at * 2u + uvec2(i & 1u, i >> 1u);
        if (any(greaterThanEqual(leaf, leaves()))) continue;
        four[i] = push.instance == 0u ? source_leaf(ivec2(leaf), mine) : sky_leaf(leaf);
    }
    return four;
}

// The sums of the four texels under a texel of a level above 0.
vec4 sums_at(uvec2 base, uint level, uvec2 at) {
    vec4 four = vec4(0.0);
    for (uint i = 0u; i < 4u; ++i) {
        uvec2 child = at * 2u + uvec2(i & 1u, i >> 1u);
        if (any(greaterThanEqual(child, level_size(base, level - 1u)))) continue;
        four[i] = sum_of(imageLoad(pyramid_image, ivec2(level_origin(base, level - 1u) + child)));
    }
    return four;
}

void reduce(vec4 mine[3]) {
    uint lane = gl_LocalInvocationIndex;
    group[lane] = mine;
    barrier();
    for (uint half_size = 32u; half_size > 0u; half_size /= 2u) {
        if (lane < half_size) {
            for (uint i = 0u; i < 3u; ++i) group[lane][i] += group[lane + half_size][i];
        }
        barrier();
    }
    uint row = gl_WorkGroupID.y + push.first_texel / 8u;
    uint index = 3u * (row * gl_NumWorkGroups.x + gl_WorkGroupID.x);
    if (lane < 3u) sums[index + lane] = group[0][lane];
}

void main() {
    uvec2 base = base_of(leaves());
    if (push.first_level == 0u) {
        vec4 mine[3] = vec4[3](vec4(0.0), vec4(0.0), vec4(0.0));
        uvec2 at = gl_GlobalInvocationID.xy + uvec2(0u, push.first_texel);
        if (all(lessThan(at, base))) {
            vec4 four = leaves_at(at, mine);
            // Clusters have their own sums.
            if (!CLUSTERS || push.instance == 1u) imageStore(pyramid_image, ivec2(at), four);
        }
        if (push.instance == 0u && push.quantum_count > 0u) reduce(mine);
        return;
    }
    // More than one level only where one work group has them all.
    for (uint level = push.first_level; level < push.end_level; ++level) {
        uvec2 size = level_size(base, level);
        for (uint y = gl_GlobalInvocationID.y; y < size.y; y += 8u * gl_NumWorkGroups.y) {
            for (uint x = gl_GlobalInvocationID.x; x < size.x; x += 8u * gl_NumWorkGroups.x) {
                ivec2 at = ivec2(level_origin(base, level) + uvec2(x, y));
                imageStore(pyramid_image, at, sums_at(base, level, uvec2(x, y)));
            }
        }
        memoryBarrierImage();
        barrier();
    }
}
