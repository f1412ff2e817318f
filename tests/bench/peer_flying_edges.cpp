#include "tests/bench/peer_flying_edges.h"

#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSMPTools.h>
#include <vtkShortArray.h>
#include <vtkSignedCharArray.h>
#include <vtkSmartPointer.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnsignedShortArray.h>

namespace isoslider::bench {
namespace {

template <class Array>
vtkSmartPointer<vtkDataArray> wrap(const PeerVolume& volume) {
    using Value = typename Array::ValueType;
    const vtkIdType count = static_cast<vtkIdType>(volume.dims[0]) * volume.dims[1] * volume.dims[2];
    auto array = vtkSmartPointer<Array>::New();
    // The filter only reads; 1: VTK does not own the memory.
    array->SetArray(const_cast<Value*>(static_cast<const Value*>(volume.samples)), count, 1);
    return array;
}

vtkSmartPointer<vtkDataArray> scalarsOf(const PeerVolume& volume) {
    switch (volume.type) {
        case PeerSample::U8: return wrap<vtkUnsignedCharArray>(volume);
        case PeerSample::I8: return wrap<vtkSignedCharArray>(volume);
        case PeerSample::U16: return wrap<vtkUnsignedShortArray>(volume);
        case PeerSample::I16: return wrap<vtkShortArray>(volume);
        case PeerSample::I32: return wrap<vtkIntArray>(volume);
        case PeerSample::F32: return wrap<vtkFloatArray>(volume);
        case PeerSample::F64: break;
    }
    return wrap<vtkDoubleArray>(volume);
}

} // namespace

struct FlyingEdges::Filter {
    vtkNew<vtkImageData> image;
    vtkNew<vtkFlyingEdges3D> filter;
};

FlyingEdges::FlyingEdges(const PeerVolume& volume, int threads, const std::string& backend)
    : filter_(std::make_unique<Filter>()) {
    vtkSMPTools::SetBackend(backend.c_str());
    vtkSMPTools::Initialize(threads);
    filter_->image->SetDimensions(volume.dims[0], volume.dims[1], volume.dims[2]);
    filter_->image->GetPointData()->SetScalars(scalarsOf(volume));
    filter_->filter->SetInputData(filter_->image);
    filter_->filter->ComputeNormalsOn();
    filter_->filter->ComputeGradientsOff();
    filter_->filter->ComputeScalarsOff();
}

FlyingEdges::~FlyingEdges() = default;

FlyingEdges::Surface FlyingEdges::extract(double isovalue) {
    filter_->filter->SetValue(0, isovalue);
    filter_->filter->Update();
    vtkPolyData* mesh = filter_->filter->GetOutput();
    Surface surface;
    surface.vertices = static_cast<std::uint64_t>(mesh->GetNumberOfPoints());
    surface.triangles = static_cast<std::uint64_t>(mesh->GetNumberOfPolys());
    surface.hasNormals = mesh->GetPointData()->GetNormals() != nullptr;
    return surface;
}

std::string FlyingEdges::backend() const { return vtkSMPTools::GetBackend(); }

} // namespace isoslider::bench
