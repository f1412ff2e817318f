#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/volume_io/volume_contents.h"

namespace isoslider::model {

/// Which scalar volume of a file to open: field, component, frame and, for grids that are not uniform, size.
/// Every setter brings what it is given into range. Window thread only.
class VolumeChoice {
public:
    /// REQUIRES: contents.fields is not empty. Begins with the preferred field.
    explicit VolumeChoice(io::VolumeContents contents);

    const io::VolumeContents& contents() const { return contents_; }
    const io::VolumeField& field() const { return contents_.fields[field_]; }
    std::size_t fieldIndex() const { return field_; }
    int component() const { return component_; } ///< from 0, or io::kMagnitude
    std::int64_t frame() const { return frame_; }
    const GridDims& size() const { return size_; } ///< grid points to resample to

    bool hasFields() const { return contents_.fields.size() > 1; }
    bool hasComponents() const { return field().components > 1; }
    bool hasFrames() const { return field().frames > 1; }
    bool hasSize() const { return field().isResampled; }

    /// Takes the field's own component, frame and size.
    void setField(std::size_t index);
    void setComponent(int component);
    void setFrame(std::int64_t frame);
    void setSize(const GridDims& size);

    /// Names of the components in order; those without a name get their number, from 0.
    std::vector<std::string> componentNames() const;
    /// Why the chosen volume cannot be opened; empty if it can.
    std::string problem() const;

    /// As little as opens this volume: what the file itself puts forward is left out, so that a volume has
    /// one set of options however it was chosen.
    io::ReadOptions options() const;
    /// The same for a preview: a grid that must be resampled is, to a small size.
    io::ReadOptions previewOptions() const;

private:
    io::VolumeContents contents_;
    std::size_t field_ = 0;
    int component_ = 0;
    std::int64_t frame_ = 0;
    GridDims size_{0, 0, 0};
};

/// True if at least one of the fields can be opened, and the user has to say which or what of it.
bool isWorthAsking(const io::VolumeContents& contents);

} // namespace isoslider::model
