#pragma once

class QDockWidget;

namespace isoslider::widgets {

/// Tab passes the panel by while another one lies over it: what is behind a tab is no hidden widget for Qt, and the
/// keyboard would be where nobody sees it.
void passByWhileCovered(QDockWidget& dock);

} // namespace isoslider::widgets
