#version 330 core
// Shades as they are seen: the same as in a pane.
in vec2 texturePlace;

uniform sampler2D shades;

out vec4 colour;

void main() {
    vec4 shade = texture(shades, texturePlace);
    if (shade.a < 0.5) // outside the volume
        discard;
    colour = vec4(shade.rgb / shade.a, 1.0);
}
