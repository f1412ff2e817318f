#include "ui/widgets/panels/shown_note.h"

#include <QCoreApplication>

#include "ui/model/pieces/piece_tints.h"
#include "ui/model/session/session.h"
#include "ui/model/surface/view_state.h"
#include "ui/widgets/panels/fact_texts.h"

namespace isoslider::widgets {
namespace {

QString tr(const char* text) { return QCoreApplication::translate("ShownNote", text); }

// Where pieces are known, their triangles are too.
QString shownPiecesText(const extract::SurfaceFrame& frame, const model::PieceOptions& options) {
    const model::PieceDisplay display(*frame.pieces, frame.geometry, options);
    const auto pieces = frame.pieces->pieces();
    std::uint64_t shown = 0, triangles = 0;
    for (std::size_t piece = 0; piece < pieces.size(); ++piece)
        if (display.isShown(piece)) {
            ++shown;
            triangles += pieces[piece].triangles;
        }
    return shown == pieces.size() ? QString()
                                  : tr("Shown: %1 of %2 pieces, %3 triangles")
                                        .arg(grouped(shown), grouped(pieces.size()), grouped(triangles));
}

} // namespace

QString shownNote(const model::Session& session, const model::ViewOptions& options) {
    const auto frame = session.frame();
    const auto* active = session.surfaces().active();
    if (!frame || active == nullptr)
        return {};
    if (!active->isVisible)
        return tr("The surface is hidden; it is counted all the same.");
    const bool isClipped = options.clipping.clipsAnything(), hidesAny = options.pieces.hidesAny();
    if (isClipped)
        return hidesAny ? tr("Hidden pieces and what is clipped are counted too.")
                        : tr("What is clipped is counted too.");
    if (!hidesAny)
        return {};
    return frame->pieces ? shownPiecesText(*frame, options.pieces) : tr("Hidden pieces are counted too.");
}

} // namespace isoslider::widgets
