#version 330 core
layout(location = 0) in vec3 position; // grid index units
layout(location = 1) in vec2 place;    // in the texture

uniform mat4 modelToView;
uniform mat4 viewToClip;
uniform vec4 cuts[7]; // half-spaces that what is drawn lies in: dot(xyz, place) + w >= 0, grid index units
uniform int cutCount;

out vec2 texturePlace;
out vec3 gridPosition;
out float gl_ClipDistance[7];

void main() {
    texturePlace = place;
    gridPosition = position;
    for (int i = 0; i < cutCount; ++i)
        gl_ClipDistance[i] = dot(cuts[i].xyz, position) + cuts[i].w;
    gl_Position = viewToClip * (modelToView * vec4(position, 1.0));
}
