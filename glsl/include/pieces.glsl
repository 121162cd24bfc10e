// What lies in a texel: the g-buffer's primitive, and in a few texels others beside it (src/pass/pieces.rs).
#ifndef PIECES_GLSL
#define PIECES_GLSL

#include "surface.glsl"

layout(set = 0, binding = 31, r32ui) readonly uniform uimage2D pieces_image;
layout(set = 0, binding = 32, std430) readonly buffer Pieces { Piece pieces[]; };

// Of a texel, and how many beside the g-buffer's.
struct Shared {
    Piece owner;
    uint first;
    uint others;
};

// `g`: the g-buffer's; the texel has a surface.
Shared pieces_of(uvec2 texel, uvec4 g) {
    uint code = SHARED_TEXELS ? imageLoad(pieces_image, ivec2(texel)).x : 0u;
    return Shared(Piece(g.x - 1u, g.y), code & 0xffffffu, code >> 24u);
}

// 0: the g-buffer's.
Piece piece_at(Shared s, uint index) {
    if (!SHARED_TEXELS || index == 0u) return s.owner;
    return pieces[s.first + index - 1u];
}

bool is_present(Piece piece) {
    return !DYNAMIC || (instances[piece.instance].flags & INSTANCE_ABSENT) == 0u;
}

// World area of all pieces.
float area_of_pieces(uvec2 texel, Shared s) {
    float area = 0.0;
    for (uint i = 0u; i <= s.others; ++i) {
        Piece piece = piece_at(s, i);
        if (is_present(piece)) area += length(area_of(patch_of(texel, piece.instance, piece.primitive)));
    }
    return area;
}

#endif
