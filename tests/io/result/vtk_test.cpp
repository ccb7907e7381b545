// VTK's own readers see what was written: counts, coordinates, cells, arrays, every value.

#include "kerf/vtk.hpp"

#include "io/files.hpp"
#include "kerf/mesher.hpp"
#include "tests/support/sample.hpp"

#include <vtkCell.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <algorithm>
#include <cmath>

namespace kerf::vtk_test {
namespace {

using test::Folder;

Eigen::MatrixXd numbers(Eigen::Index rows, Eigen::Index columns, double seed) {
  Eigen::MatrixXd out(rows, columns);
  for (Eigen::Index i = 0; i < out.size(); ++i) out.data()[i] = std::sin(seed + 0.7 * double(i)) / 3;
  return out;
}

/// `components` as read; further ones (the padding of 2-vectors) are zero.
void expect_same(vtkDataSetAttributes* attributes, const NamedField& field, int components) {
  vtkDataArray* array = attributes->GetArray(field.name.c_str());
  ASSERT_NE(array, nullptr) << field.name;
  ASSERT_EQ(array->GetDataType(), VTK_DOUBLE) << field.name;
  ASSERT_EQ(array->GetNumberOfComponents(), components) << field.name;
  ASSERT_EQ(array->GetNumberOfTuples(), field.values.cols()) << field.name;
  for (Eigen::Index i = 0; i < field.values.cols(); ++i) {
    for (int k = 0; k < components; ++k) {
      ASSERT_EQ(array->GetComponent(i, k), k < field.values.rows() ? field.values(k, i) : 0.0) << field.name;
    }
  }
}

// Triangles at an arc are quadratic ones, with points on the arc that neighbors share; all others stay as they are.
TEST(Vtk, CurvedTrianglesReadBack) {
  const Folder folder;
  Shape shape{circle("outline", {0, 0}, 2, 0), {}, {}, {"rim", "hole"}, {}};
  shape.holes.push_back(circle("hole", {0, 0}, 1, 1));
  const Mesh mesh = triangulate(shape, {.size = 0.3, .curved = true});
  const auto corners = static_cast<Eigen::Index>(mesh.points.size());
  Eigen::MatrixXd x(2, corners);
  for (Eigen::Index i = 0; i < corners; ++i) x.col(i) = mesh.points[std::size_t(i)];
  const auto path = folder.path / "a.vtu";
  write_vtu(path, mesh.points, mesh.triangles, std::vector<NamedField>{{"x", false, x}},
            middle_points(mesh, mesh.triangles));
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  vtkUnstructuredGrid* read = reader->GetOutput();
  ASSERT_EQ(read->GetNumberOfCells(), vtkIdType(mesh.triangles.size()));
  int on_arcs = 0, quadratic = 0;
  for (vtkIdType t = 0; t < read->GetNumberOfCells(); ++t) {
    int arcs = 0;
    for (const Index e : mesh.edges_of[std::size_t(t)]) arcs += mesh.arc[std::size_t(e)] != none;
    ASSERT_EQ(read->GetCellType(t), arcs > 0 ? VTK_QUADRATIC_TRIANGLE : VTK_TRIANGLE);
    if (arcs == 0) continue;
    ++quadratic;
    vtkCell* cell = read->GetCell(t);
    for (int i = 0; i < 3; ++i) {
      double m[3];
      read->GetPoint(cell->GetPointId(3 + i), m);
      const double r = std::hypot(m[0], m[1]);
      on_arcs += std::abs(r - 1) < 1e-14 || std::abs(r - 2) < 1e-14;
      for (int k = 0; k < 2; ++k)  // the mean of the ends
        EXPECT_DOUBLE_EQ(read->GetPointData()->GetArray("x")->GetComponent(cell->GetPointId(3 + i), k),
                         (x(k, cell->GetPointId(i)) + x(k, cell->GetPointId((i + 1) % 3))) / 2);
    }
  }
  EXPECT_EQ(on_arcs, quadratic);
  EXPECT_EQ(quadratic, std::ranges::count_if(mesh.arc, [](Index a) { return a != none; }));
  EXPECT_LT(read->GetNumberOfPoints(), corners + 3 * quadratic);
}

TEST(Vtk, UnstructuredGridReadsBack) {
  const Folder folder;
  const Picture grid = test::grid({-1, 2}, {3, 5}, 7, 5, [](const Vec2&) { return 0.0; });
  const auto points = static_cast<Eigen::Index>(grid.points.size());
  const auto cells = static_cast<Eigen::Index>(grid.triangles.size());
  const std::vector<NamedField> fields = {
      {"u", false, numbers(2, points, 1)},         {"sigma", false, numbers(3, points, 2)},
      {"sigma_raw", false, numbers(4, points, 3)}, {"von_mises", false, numbers(1, points, 4)},
      {"error", true, numbers(1, cells, 5)},       {"cell_vector", true, numbers(2, cells, 6)},
  };
  const auto path = folder.path / "state.vtu";
  write_vtu(path, grid.points, grid.triangles, fields);
  EXPECT_FALSE(std::filesystem::exists(folder.path / "state.vtu.part"));

  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  vtkUnstructuredGrid* read = reader->GetOutput();
  ASSERT_EQ(read->GetNumberOfPoints(), points);
  ASSERT_EQ(read->GetNumberOfCells(), cells);
  for (Eigen::Index i = 0; i < points; ++i) {
    double x[3];
    read->GetPoint(i, x);
    EXPECT_EQ(x[0], grid.points[std::size_t(i)].x());
    EXPECT_EQ(x[1], grid.points[std::size_t(i)].y());
    EXPECT_EQ(x[2], 0);
  }
  for (Eigen::Index t = 0; t < cells; ++t) {
    ASSERT_EQ(read->GetCellType(t), VTK_TRIANGLE);
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(read->GetCell(t)->GetPointId(k), grid.triangles[std::size_t(t)][std::size_t(k)]);
    }
  }
  EXPECT_EQ(read->GetPointData()->GetNumberOfArrays(), 4);
  EXPECT_EQ(read->GetCellData()->GetNumberOfArrays(), 2);
  for (const NamedField& field : fields) {
    const int rows = static_cast<int>(field.values.rows());
    vtkDataSetAttributes* attributes = read->GetPointData();
    if (field.per_cell) attributes = read->GetCellData();
    expect_same(attributes, field, rows == 2 ? 3 : rows);
  }
  const char* names[] = {"xx", "yy", "xy", "yx"};
  for (int k = 0; k < 4; ++k) {
    EXPECT_STREQ(read->GetPointData()->GetArray("sigma_raw")->GetComponentName(k), names[k]);
    if (k < 3) {
      EXPECT_STREQ(read->GetPointData()->GetArray("sigma")->GetComponentName(k), names[k]);
    }
  }
}

TEST(Vtk, PolyDataReadsBack) {
  const Folder folder;
  const std::vector<std::vector<Vec2>> lines = {{{0, 0}, {1, 0.5}, {2, 0}}, {{5, 5}, {6, 1.0 / 3}, {7, 0}}};
  const std::vector<NamedField> fields = {{"jump_n", false, numbers(1, 6, 1)}, {"crack", true, numbers(1, 2, 2)}};
  const auto path = folder.path / "crack_c.vtp";
  write_vtp(path, lines, fields);
  vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  vtkPolyData* read = reader->GetOutput();
  ASSERT_EQ(read->GetNumberOfPoints(), 6);
  ASSERT_EQ(read->GetNumberOfLines(), 2);
  vtkIdType next = 0;
  for (int cell = 0; cell < 2; ++cell) {
    const auto& line = lines[std::size_t(cell)];
    EXPECT_EQ(read->GetCellType(cell), VTK_POLY_LINE);
    ASSERT_EQ(read->GetCell(cell)->GetNumberOfPoints(), vtkIdType(line.size()));
    for (std::size_t i = 0; i < line.size(); ++i) {
      EXPECT_EQ(read->GetCell(cell)->GetPointId(int(i)), next);
      EXPECT_EQ(read->GetPoint(next)[0], line[i].x());
      EXPECT_EQ(read->GetPoint(next++)[1], line[i].y());
    }
  }
  expect_same(read->GetPointData(), fields[0], 1);
  expect_same(read->GetCellData(), fields[1], 1);
}

TEST(Vtk, LonePointsAreVertices) {
  const Folder folder;
  const std::vector<std::vector<Vec2>> points = {{{0, 0}}, {{1, 0.5}}};
  const std::vector<NamedField> fields = {{"lower", false, numbers(1, 2, 1)}};
  write_vtp(folder.path / "points.vtp", points, fields);
  vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName((folder.path / "points.vtp").c_str());
  reader->Update();
  vtkPolyData* read = reader->GetOutput();
  EXPECT_EQ(read->GetNumberOfVerts(), 2);
  EXPECT_EQ(read->GetNumberOfLines(), 0);
  expect_same(read->GetPointData(), fields[0], 1);
}

TEST(Vtk, KeepsWhatIsNotFinite) {
  const Folder folder;
  const Picture grid = test::grid({0, 0}, {1, 1}, 1, 1, [](const Vec2&) { return 0.0; });
  Eigen::MatrixXd values(1, 4);
  values << 1, std::nan(""), infinity, -infinity;
  write_vtu(folder.path / "a.vtu", grid.points, grid.triangles, std::vector<NamedField>{{"f", false, values}});
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName((folder.path / "a.vtu").c_str());
  reader->Update();
  vtkDataArray* read = reader->GetOutput()->GetPointData()->GetArray("f");
  ASSERT_NE(read, nullptr);
  EXPECT_EQ(read->GetComponent(0, 0), 1);
  EXPECT_TRUE(std::isnan(read->GetComponent(1, 0)));
  EXPECT_EQ(read->GetComponent(2, 0), infinity);
  EXPECT_EQ(read->GetComponent(3, 0), -infinity);
}

TEST(Vtk, NothingAtAllIsAFileToo) {
  const Folder folder;
  write_vtu(folder.path / "empty.vtu", {}, {}, {});
  write_vtp(folder.path / "empty.vtp", {}, {});
  vtkNew<vtkXMLUnstructuredGridReader> grid;
  grid->SetFileName((folder.path / "empty.vtu").c_str());
  grid->Update();
  EXPECT_EQ(grid->GetOutput()->GetNumberOfCells(), 0);
  vtkNew<vtkXMLPolyDataReader> lines;
  lines->SetFileName((folder.path / "empty.vtp").c_str());
  lines->Update();
  EXPECT_EQ(lines->GetOutput()->GetNumberOfCells(), 0);
}

TEST(Vtk, SameInputSameBytes) {
  const Folder folder;
  const Picture grid = test::grid({0, 0}, {1, 1}, 5, 5, [](const Vec2&) { return 0.0; });
  const std::vector<NamedField> fields = {{"u", false, numbers(2, Eigen::Index(grid.points.size()), 1)}};
  write_vtu(folder.path / "a.vtu", grid.points, grid.triangles, fields);
  write_vtu(folder.path / "b.vtu", grid.points, grid.triangles, fields);
  EXPECT_EQ(read_file(folder.path / "a.vtu"), read_file(folder.path / "b.vtu"));
}

TEST(Vtk, UnwritablePathIsAnErrorThatNamesIt) {
  const Folder folder;
  const auto path = folder.path / "missing" / "state.vtu";
  try {
    write_vtu(path, {}, {}, {});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.fault, Fault::Files);
    EXPECT_NE(std::string(error.what()).find(path.string()), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("No such file or directory"), std::string::npos);
  }
}

TEST(Vtk, MissingModuleSaysWhatToDo) {
  // A copy of this program far from the module, asked to write a file.
  const Folder folder;
  std::filesystem::copy_file("/proc/self/exe", folder.path / "lonely");
  const std::string command = "env -u LD_LIBRARY_PATH -u GTEST_TOTAL_SHARDS -u GTEST_SHARD_INDEX '" +
                              (folder.path / "lonely").string() + "' --gtest_filter=Vtk.NothingAtAllIsAFileToo 2>&1";
  FILE* pipe = popen(command.c_str(), "r");
  ASSERT_NE(pipe, nullptr);
  std::string said;
  for (char block[4096]; const std::size_t count = fread(block, 1, sizeof block, pipe);) said.append(block, count);
  EXPECT_NE(pclose(pipe), 0);
  EXPECT_NE(said.find("cannot load the VTK module kerf_vtk.so"), std::string::npos) << said;
  EXPECT_NE(said.find("vtk = false"), std::string::npos) << said;
}

TEST(Vtk, FieldOfTheWrongLengthIsRefused) {
  const Folder folder;
  const Picture grid = test::grid({0, 0}, {1, 1}, 1, 1, [](const Vec2&) { return 0.0; });
  const std::vector<NamedField> fields = {{"u", false, numbers(2, 3, 1)}};
  EXPECT_THROW(write_vtu(folder.path / "a.vtu", grid.points, grid.triangles, fields), std::invalid_argument);
  const std::vector<std::array<Index, 3>> wrong = {{0, 1, 4}};
  EXPECT_THROW(write_vtu(folder.path / "a.vtu", grid.points, wrong, {}), std::invalid_argument);
  EXPECT_FALSE(std::filesystem::exists(folder.path / "a.vtu"));
}

}  // namespace
}  // namespace kerf::vtk_test
