// Where the rays of a bounce epoch ended.
#ifndef LINKS_GLSL
#define LINKS_GLSL

layout(set = 0, binding = 41, std430) buffer Links { Link links[]; };

// Of a ray of the texel at `place` of the list of texels: neighbours' links lie side by side.
uint link_place(uint place, uint ray) {
    return ray * push.link_stride + place;
}

#endif
