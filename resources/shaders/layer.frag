#version 330 core
// One layer of transparent surfaces, or all of them, as they are: colours times opacity, and opacity.
uniform sampler2D layer;

out vec4 colour;

void main() { colour = texelFetch(layer, ivec2(gl_FragCoord.xy), 0); }
