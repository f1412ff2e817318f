#version 330 core
// A ring with four ticks, dark around it so that it is seen on any surface.
in vec2 corner;

uniform vec4 markerColour; // as seen; a: strength
uniform float halfPixels;  // of the square
uniform float pixelRatio;  // pixels of a line of width 1

out vec4 colour;

void main() {
    vec2 place = corner * halfPixels / pixelRatio;
    vec2 size = abs(place);
    float radius = 0.6 * halfPixels / pixelRatio;
    float toRing = abs(length(place) - radius);
    float along = max(size.x, size.y);
    float toTick = max(min(size.x, size.y), max(radius + 2.0 - along, along - (radius + 8.0)));
    float away = min(toRing, toTick + 0.3);
    float line = 1.0 - smoothstep(0.7, 1.6, away);
    float around = 1.0 - smoothstep(1.6, 3.4, away);
    colour = vec4(markerColour.rgb * line, markerColour.a * max(line, 0.6 * around));
}
