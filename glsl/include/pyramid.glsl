// A mip map as a cumulative distribution: a pyramid of 2 x 2 sums over leaves, walked from its top to choose one.
//
// Its levels lie in one image: level 0 at the left, the others below each other at its right. A texel of a level holds
// its four children, (0,0), (1,0), (0,1), (1,1); those of level 0 are the leaves. Sides are powers of two; what lies
// beyond the leaves is 0. The host's twin is src/pass/importance.rs.
#ifndef PYRAMID_GLSL
#define PYRAMID_GLSL

// Random numbers of a walk begin at this dimension.
const uint WALK_DIMENSION = 16u;

uvec2 power_of_two(uvec2 n) {
    return uvec2(1u) << uvec2(findMSB(n - 1u) + 1);
}

// Size of level 0.
uvec2 base_of(uvec2 leaves) {
    return power_of_two((max(leaves, uvec2(1u)) + 1u) / 2u);
}

uint levels_of(uvec2 base) {
    return uint(findMSB(max(base.x, base.y))) + 1u;
}

uvec2 level_size(uvec2 base, uint level) {
    return max(base >> level, uvec2(1u));
}

uvec2 level_origin(uvec2 base, uint level) {
    if (level == 0u) return uvec2(0u);
    // Heights of levels 1 to level - 1, which do not fall below 1.
    uint above = level - 1u;
    uint halvings = uint(findMSB(base.y));
    uint rows = above <= halvings ? base.y - (base.y >> above) : base.y - 1u + above - halvings;
    return uvec2(base.x, rows);
}

float sum_of(vec4 children) {
    return (children.x + children.y) + (children.z + children.w);
}

float pyramid_total(texture2D pyramid, uvec2 leaves) {
    uvec2 base = base_of(leaves);
    return sum_of(texelFetch(pyramid, ivec2(level_origin(base, levels_of(base) - 1u)), 0));
}

float pyramid_leaf(texture2D pyramid, uvec2 leaf) {
    vec4 siblings = texelFetch(pyramid, ivec2(leaf / 2u), 0);
    return siblings[(leaf.x & 1u) | (leaf.y & 1u) << 1u];
}

// The child in whose part of the sum `x` lies, and where that part begins. Never one that is 0: rounding may carry `x` to
// the end of the last part.
uint child_at(vec4 children, float x, out float start) {
    vec4 starts = vec4(0.0, children.x, children.x + children.y, (children.x + children.y) + children.z);
    uint child = uint(x >= starts.y) + uint(x >= starts.z) + uint(x >= starts.w);
    while (child > 0u && children[child] == 0.0) --child;
    start = starts[child];
    return child;
}

// Chooses a leaf with a probability in proportion to its value; false: all are 0. `u` in [0,1) decides at every level: what
// is left of it at the next one has lost bits, which are made up for by fresh ones.
bool choose_leaf(texture2D pyramid, uvec2 leaves, float u, uint texel, uint sample_index, out uvec2 leaf) {
    uvec2 base = base_of(leaves);
    uint levels = levels_of(base);
    vec4 fresh = vec4(0.0);
    leaf = uvec2(0u);
    for (uint down = 0u; down < levels; ++down) {
        if (down % 4u == 0u) fresh = random4(texel, sample_index, WALK_DIMENSION + down / 4u);
        vec4 children = texelFetch(pyramid, ivec2(level_origin(base, levels - 1u - down) + leaf), 0);
        float sum = sum_of(children);
        if (!(sum > 0.0)) return false;
        float start;
        uint child = child_at(children, u * sum, start);
        float inverse = 1.0 / children[child];
        u = (u * sum - start) * inverse + fresh[down % 4u] * (sum * inverse / 16777216.0);
        u = clamp(u, 0.0, 0.99999994);
        leaf = leaf * 2u + uvec2(child & 1u, child >> 1u);
    }
    return true;
}

#endif
