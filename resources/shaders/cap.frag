#version 330 core
// What a clip plane lays open of the inside: where the samples on it reach the isovalue.
in vec2 texturePlace;
in vec3 gridPosition; // grid index units

uniform sampler2D samples; // r: value, g: 1 where it is known
uniform float isovalue;
uniform vec3 capColour;    // linear light, lit
uniform float capLight;    // that colours of values are in
uniform vec2 greyWindow;   // black, and what white is above it
uniform float valueShare;  // 1: the samples in grey, 0: the colour

out vec4 colour;

void main() {
    vec2 pixel = texture(samples, texturePlace).rg;
    // The surface's triangles are chords of the contour here: most of a pixel more, so that no gap shows between.
    float above = pixel.r - isovalue * pixel.g;
    if (pixel.g < 0.5 || !(above >= -0.75 * fwidth(above)))
        discard;
    float grey = clamp((pixel.r / pixel.g - greyWindow.x) / greyWindow.y, 0.0, 1.0);
    vec3 filling = scalarKind == 0 ? capColour : scalarColour(gridPosition) * capLight;
    colour = vec4(mix(pow(filling, vec3(1.0 / 2.2)), vec3(grey), valueShare), 1.0);
}
