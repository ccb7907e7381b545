import gmsh
gmsh.initialize(); gmsh.option.setNumber("General.Terminal",0)
gmsh.model.add("p")
r=gmsh.model.occ.addRectangle(0,0,0,4,2); d=gmsh.model.occ.addDisk(1,1,0,0.4,0.4); e=gmsh.model.occ.addDisk(3,1,0,0.5,0.25)
gmsh.model.occ.cut([(2,r)],[(2,d),(2,e)]); gmsh.model.occ.synchronize(); gmsh.write("holes.step"); gmsh.write("holes.brep")
