<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE TS>
<TS version="2.1">
<context>
  <name>TerrainWavelets</name>
  <message>
    <location filename="../../plugin/algorithms/_analysis.py"/>
    <source>Analysing (the first run also compiles, up to half a minute)</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_analysis.py"/>
    <source>Checking that the input comes back</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_analysis.py"/>
    <source>Coarse TIN</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_analysis.py"/>
    <source>GeoPackage (*.gpkg)</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_analysis.py"/>
    <source>Layers in the pyramid</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_analysis.py"/>
    <source>Measuring the errors of every level</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_analysis.py"/>
    <source>One GeoPackage with everything: the arrays from which every level is rebuilt exactly, and the coarse TIN and details as styled layers.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_analysis.py"/>
    <source>Pyramid</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_analysis.py"/>
    <source>The triangles of the coarsest level, with elevation and slope.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_analysis.py"/>
    <source>Which layers the pyramid file has, which is complete without them: the coarse TIN, up to 50,000 vertices, and the details of the coarser levels, up to 80,000 features (auto), those of all levels, the coarse TIN only, or none.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_analysis.py"/>
    <source>{} vertices, {} triangles</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>A file, or a point cloud layer of the project, by its name or id: its filter by class and its CRS count. Read by the plugin itself, so no point cloud support in QGIS is needed.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Attributes</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>CRS of the points</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Classes</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Classes are numbers separated by commas, such as 2,9.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Gaps at the outline only</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Height of points at one place</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Instead of the CRS in the file, or where it has none.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Keep all other dimensions</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Keep points of noise</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Keep what is not transformed (GPS time, flags, ...) in the pyramid, so that the reconstructed file has it too.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Keep withheld points</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Leave out only what such edges open to the outside; gaps inside stay closed.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Let points of the classes 7 and 18 be part of the surface. Otherwise they are only carried, and the reconstructed file has them.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Longest edge</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Names of further dimensions of the file, separated by commas.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Only points of these ASPRS classes, separated by commas: 2 for the ground, 2,9 for ground and water. Empty for all points.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Only points of these ASPRS classes, separated by commas: 2 for the ground, 2,9 for ground and water. Empty for those of the ground, if the file has them, else for all.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Other attributes</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Point cloud</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Reading the points</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Taken: all points, since none is classified as ground (class 2)</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Taken: the {} points of the ground (class 2), of {}</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>The filter of the layer {} leaves: {}</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>The same for points with the withheld flag.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Triangles with a longer edge are left out, as gaps of the point cloud; in the unit of x and y, or metres for a geographic CRS. 0 for five times the spacing that 95 % of the points keep; empty to fill the convex hull.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Triangulating {} points</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Unpacked by QGIS's pdal_wrench, since lazrs is missing</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>What is transformed along with the elevation. &lt;i&gt;hag&lt;/i&gt; is the height above the TIN of the ground points (class 2), in the unit of elevation.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>Which height points have that share x and y; each of them comes back.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>{} classes</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>{}: QGIS does not understand the CRS in the file; choose one.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_input.py"/>
    <source>{}: its filter leaves none of the classes that are named; change one.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_source.py"/>
    <source>{}: its filter, {}, asks for more than classes; export the layer, or filter by Classification alone.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_source.py"/>
    <source>{}: its filter, {}, lets no class through; change it.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_source.py"/>
    <source>{}: there is no such file; choose a point cloud.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_cloud_source.py"/>
    <source>{}: this layer is of {}, and local LAS, LAZ and COPC files are what is read; export it as one.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_dem_input.py"/>
    <source>Band</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_dem_input.py"/>
    <source>Band with the elevations.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_dem_input.py"/>
    <source>DEM</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_dem_input.py"/>
    <source>Raster of elevations, in any CRS; degrees are worked on in a local metric frame. Cells without data become holes.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_dem_input.py"/>
    <source>Reading the DEM</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_pyramid_input.py"/>
    <source>Changed since its analysis: {}</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_pyramid_input.py"/>
    <source>GeoPackage that one of the analyses made. Those of this session, temporary ones too, and those with a layer in the project are in the list.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_pyramid_input.py"/>
    <source>Levels are numbers separated by commas, such as 0,4,8.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_pyramid_input.py"/>
    <source>Pyramid (*.gpkg)</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_pyramid_input.py"/>
    <source>Reading the pyramid</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_pyramid_input.py"/>
    <source>{}: there is no such file; choose a pyramid.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>Angles {:.3g} to {:.3g} degrees, edges {:.4g} to {:.4g}, areas to {:.4g}</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>By how much edges may grow for each unit of distance, from where sizes or the TIN are finer; such as 0.2.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>Field with the largest area</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>Field with the longest edge</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>Give a raster of longest edges, or one longest edge, not both.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>Give zones of other sizes and a field with their size, or neither.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>Growth of edges for a solver</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>In degrees, at most 30; 25 where another of these bounds is given. Nodes are added to the TIN until all bounds hold. Needs the Python packages cgal and shapely.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>In the unit of the CRS, metres for degrees: no edge is longer.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>Instead of one number: the longest edge by place; any where there is no data.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>Its area, in the squared unit of the CRS.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>Largest triangle for a solver</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>Longest edge for a solver</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>Meshing for a solver</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>No two vertices of the TIN are nearer, but for those of outline and lines.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>Of the zones of other sizes.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>Polygons with a longest edge or a largest area of their own; where several overlap, the least counts. The sizes above hold outside.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>Raster of longest edges</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>Shortest edge for a solver</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>Smallest angle for a solver</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_solver_input.py"/>
    <source>Zones of other sizes for a solver</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_tiles_input.py"/>
    <source>A tile of a DEM has a whole number of cells along its side.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_tiles_input.py"/>
    <source>DEMs</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_tiles_input.py"/>
    <source>Give DEMs or point clouds, one of the two.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_tiles_input.py"/>
    <source>Instead of the CRS in the files, or where they have none.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_tiles_input.py"/>
    <source>Instead: LAS, LAZ or COPC files of one point format, an &lt;i&gt;ept.json&lt;/i&gt;, or a folder of them. Each is read once, a million points at a time.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_tiles_input.py"/>
    <source>Of the DEMs: the band with the elevations.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_tiles_input.py"/>
    <source>Of the point clouds: names of dimensions that are transformed along with the elevation, separated by commas, such as intensity. All others come back, too.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_tiles_input.py"/>
    <source>Of the point clouds: only points of these ASPRS classes, separated by commas. Empty for all points.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_tiles_input.py"/>
    <source>One raster of any size, or several with cells in one grid; where they overlap, the first that has data counts. Layers of files on this machine, read as the files are.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_tiles_input.py"/>
    <source>Or point clouds</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_tiles_input.py"/>
    <source>{}: its CRS is {}, that of {} is {}; reproject it.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_tiles_input.py"/>
    <source>{}: its properties change which values are nodata, and tiles take the file as it is; export the layer, or take that change back.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/_tiles_input.py"/>
    <source>{}: tiles are made of raster files on this machine, and this layer is none; export it as one.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_dem.py"/>
    <source>Analyse DEM</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_dem.py"/>
    <source>DEM to a reversible pyramid of TINs with details by scale</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_dem.py"/>
    <source>Turns a DEM into a reversible wavelet pyramid: a coarse TIN and one layer of details for each level of resolution, in one GeoPackage. From it &lt;i&gt;Extract level&lt;/i&gt; gives the terrain at any level and &lt;i&gt;Reconstruct&lt;/i&gt; the DEM itself, bit for bit.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_dem.py"/>
    <source>dem,dtm,raster,tin from dem,pyramid,wavelet,multiresolution,level of detail,analyze</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_point_cloud.py"/>
    <source>Analyse point cloud</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_point_cloud.py"/>
    <source>LAS, LAZ or COPC file to a reversible pyramid of TINs with details by scale</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_point_cloud.py"/>
    <source>Triangulates the points of a LAS, LAZ or COPC file and turns them into a reversible wavelet pyramid. Attributes such as class, intensity, colour or height above ground are transformed together with the elevation. &lt;i&gt;Reconstruct&lt;/i&gt; gives the file back with exactly its integers.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_point_cloud.py"/>
    <source>las,laz,copc,lidar,point cloud,tin,pyramid,wavelet,multiresolution,analyze</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>A line that is laid on the terrain keeps only as many vertices as it needs to be nowhere farther above or below it, in the unit of elevation. Empty for the largest error where that is a stop rule, else for a thousandth of the relief.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Along breaklines and outline: RMSE {:.4g}, largest error {:.4g}</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Analyse points or TIN</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Become edges of the TIN. Without Z they are laid on the TIN of the points, all along; with Z they keep it. Where they cross, they are cut.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Breaklines</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Breaklines and clip polygons are for points; the edges of a triangle layer stay as they are. Take its vertices, or leave them out.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Clip polygon</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Field that locks points</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Field with the elevation</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Keep the vertices of breaklines and of the outline, and so the lines, at every level.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Largest error along breaklines and outline, in the unit of elevation</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Laying lines on the terrain</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Lock breaklines and outline</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>No breakline is where the points are; check that the layers overlap, or leave the breaklines out.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>No point is inside the clip polygon; check that the layers overlap.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Numeric fields of points that are transformed along with the elevation.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Of points; empty for the Z of the geometry.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Only the terrain inside; its outline becomes edges of the TIN and is laid on the TIN of the points.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Points or triangles</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Points whose value is anything but 0, false or NULL stay at every level.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Points with Z or with a field of elevations, or polygons with Z that are all triangles. Of points at the same x and y the lowest is taken.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Points with breaklines, or triangles, to a reversible pyramid of TINs</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>RMSE along breaklines and outline, in the unit of elevation</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Reading the triangles</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Tolerance along lines without Z</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>Turns a layer of points or of triangles into a reversible wavelet pyramid. Points are triangulated (Delaunay in plan), with breaklines as edges and clipped to a polygon if wanted. Locked points and the vertices of breaklines stay at every level, where they are and as high as they are.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/analyse_tin.py"/>
    <source>tin,points,triangles,triangulate,delaunay,breaklines,survey,pyramid,wavelet,multiresolution,analyze</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/change_by_scale.py"/>
    <source>Change by scale</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/change_by_scale.py"/>
    <source>Earlier DEM</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/change_by_scale.py"/>
    <source>Highest change, in the unit of elevation</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/change_by_scale.py"/>
    <source>How much terrain has risen since an earlier DEM, all of it and by scale</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/change_by_scale.py"/>
    <source>In the CRS of the pyramid, which is of the later survey; its cells may differ.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/change_by_scale.py"/>
    <source>Lowest change, in the unit of elevation</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/change_by_scale.py"/>
    <source>Mean change, in the unit of elevation</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/change_by_scale.py"/>
    <source>Root mean square change, in the unit of elevation</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/change_by_scale.py"/>
    <source>Takes an earlier DEM from the terrain of a pyramid, and the difference apart by scale: a landslide or a mound is in the coarse bands, ploughing and the noise of a survey in the fine ones. All bands add up to the change. Analyse the later survey with the partition &lt;i&gt;random&lt;/i&gt; and the prediction &lt;i&gt;plane&lt;/i&gt;, whose levels mean the same scale everywhere.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/change_by_scale.py"/>
    <source>Taking the change apart</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/change_by_scale.py"/>
    <source>The first band is all of the change, in the unit of elevation: red is added, blue taken away. Then what is coarser than all levels, and a band for each scale.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/change_by_scale.py"/>
    <source>change,dod,dem of difference,erosion,deposition,scale,time,survey,pyramid,wavelet</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/change_by_scale.py"/>
    <source>spacing {}: {} root mean square, {} to {}</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/classify_ground.py"/>
    <source>All points, with all their dimensions. LAZ needs the Python package lazrs.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/classify_ground.py"/>
    <source>Classified point cloud</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/classify_ground.py"/>
    <source>Classify ground</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/classify_ground.py"/>
    <source>Height tolerance</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/classify_ground.py"/>
    <source>LAS (*.las);;LAZ (*.laz)</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/classify_ground.py"/>
    <source>LAS, LAZ or COPC file to the same with its ground points marked</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/classify_ground.py"/>
    <source>Largest object</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/classify_ground.py"/>
    <source>Least slope</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/classify_ground.py"/>
    <source>Looking for the ground among {} points</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/classify_ground.py"/>
    <source>Marks the ground points of a LAS, LAZ or COPC file, from their heights alone and without training: what stands above the lows around it, at any scale, by more than the slope of the ground explains, is no ground. The ground gets class 2, all else 1; noise and withheld points keep their class, and nothing but classes is changed.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/classify_ground.py"/>
    <source>Points</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/classify_ground.py"/>
    <source>Points of the ground</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/classify_ground.py"/>
    <source>Points so far above or below the ground's surface are part of it, in metres.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/classify_ground.py"/>
    <source>Rise over run that the ground may have everywhere; on slopes more, by itself. Larger values keep more banks and let more low things through.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/classify_ground.py"/>
    <source>Width of the largest building, in metres; wider ones are taken for ground.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/classify_ground.py"/>
    <source>Writing {}</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/classify_ground.py"/>
    <source>ground,ground filter,classify,classification,bare earth,dtm,smrf,csf,las,laz,lidar,point cloud,vegetation,buildings</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/classify_ground.py"/>
    <source>the classified point cloud</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/classify_ground.py"/>
    <source>{} of {} points are ground</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>&lt;i&gt;kmeans&lt;/i&gt;, or a &lt;i&gt;mixture&lt;/i&gt; of Gaussians of different size and shape.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>A raster of labels; each cell has that of the nearest vertex.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Accuracy in blocks left out, 0 to 1</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Channels</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Channels whose scales count, separated by commas: z and attributes. Empty for the geometry.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Choose the layer of training areas and its field of classes.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Classes that stand for 'not known', separated by commas.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Cluster details</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Clustered vertices</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Empty for a number found from the data (2 to 10).</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Every input vertex with its label and how clearly it belongs there (0 to 1).</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Field with the class</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Gathering the spectrum of each vertex, and clustering</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Gathering the spectrum of each vertex, and learning the classes</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Groups terrain by its scale signature: how much detail each place has at each level. Without a teacher, places that are alike form clusters, numbered from smooth to rough. With training areas, or with the classes that some points of a LAS file have, the classes are learned and predicted for the rest. Analyse with the partition &lt;i&gt;random&lt;/i&gt; and the prediction &lt;i&gt;plane&lt;/i&gt; for levels that mean the same scale everywhere.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>JSON (*.json)</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>LAS classes are numbers separated by commas, such as 0,1.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>LAS classes to predict</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Learn from</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Map of clusters</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Method</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>No vertex is inside a training area; check that the layers overlap.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Number of clusters</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Of the random samples and starts; the same seed gives the same result.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Polygons inside which the class is known.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Predict blocks of the map from the others, and say how many of their labels come out right. Takes several times as long.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Report the accuracy</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Seed</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Size and spectrum of each cluster.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Summary of the clusters</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Terrain grouped into clusters, or classes, by its details at each scale</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Training areas</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Whether clusters are found, or classes learned, and from what.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>Whole numbers from 0 to 254.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>class</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>cluster</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/cluster_details.py"/>
    <source>cluster,classification,scale signature,spectrum,landform,k-means,machine learning</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/contours.py"/>
    <source>0 is the coarsest. Empty for the coarsest whose RMSE is at most a fifth of the interval.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/contours.py"/>
    <source>Base</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/contours.py"/>
    <source>Contour lines of one level of a pyramid, the smoother the coarser the level</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/contours.py"/>
    <source>Contours</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/contours.py"/>
    <source>Contours of level</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/contours.py"/>
    <source>Drawing the contours</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/contours.py"/>
    <source>Draws the contours of one level of a pyramid, straight in each triangle and never crossing. A coarse level has few and smooth ones. Higher ground is on the right of a line; every fifth is marked, and drawn thick.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/contours.py"/>
    <source>Height that the intervals are counted from.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/contours.py"/>
    <source>In the unit of elevation; empty or 0 for a round one that gives about twenty.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/contours.py"/>
    <source>Interval</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/contours.py"/>
    <source>Level</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/contours.py"/>
    <source>Level {}, a contour each {:g}</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/contours.py"/>
    <source>Lines with Z and the fields &lt;i&gt;elevation&lt;/i&gt; and &lt;i&gt;is_index&lt;/i&gt;.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/contours.py"/>
    <source>Number of contours</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/contours.py"/>
    <source>contour,contours,isolines,lines,elevation,tin,generalise,generalize,smooth,level,wavelet,pyramid</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>A raster with one band for each level: the root mean square detail around each place, in the unit of elevation. It maps at which scale the terrain is rough.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>Coarsest level</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>Degrees between the surface and the smooth one of a scale, averaged over its neighbourhoods. The first band is the largest of all scales, the second the distance on the ground at which it is found; then a band for each scale.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>Detail layers</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>Details by level</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>Details of this level and coarser ones; empty for all.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>Details of this level and finer ones.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>Deviation by scale</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>Energy by level</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>Fields: &lt;i&gt;vertex_id&lt;/i&gt; in the input, &lt;i&gt;level&lt;/i&gt;, &lt;i&gt;w_…&lt;/i&gt; the detail of a channel, &lt;i&gt;magnitude&lt;/i&gt; the length of the detail vector.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>Finest level</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>Gathering the scales</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>Height above the surroundings in their standard deviations: above 0 on ridges, below in valleys. The first band is the strongest of all scales, the second the distance on the ground at which it is found; then a band for each scale.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>Largest magnitude</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>Leave out points whose detail vector is shorter (in the unit of elevation where elevation alone is lifted).</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>Number of points</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>Roughness by scale</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>Shows at which scale the terrain has its detail: a point for every vertex that the analysis removed, with the level at which it went and its detail vector (the wavelet coefficients). Points are coloured by level and sized by magnitude, as in Fig. 10b of the paper. Level 0 is the coarsest. For scales that mean the same everywhere, analyse with the partition &lt;i&gt;random&lt;/i&gt; and the prediction &lt;i&gt;plane&lt;/i&gt;; the default partition takes detail out where it matters least first.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>Smallest magnitude</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>The coarsest level, {}, is finer than the finest, {}; exchange them.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>The details (wavelet coefficients) of a pyramid as points, and their energy</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>This pyramid has no level, so it has no details.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/detail_layers.py"/>
    <source>wavelet coefficients,detail,scale,vertex-frequency,points,pyramid</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/difference.py"/>
    <source>0 is the coarsest.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/difference.py"/>
    <source>A DEM has its own cell size; leave the other one empty.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/difference.py"/>
    <source>A level of a pyramid less another level, or less a DEM, as a raster</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/difference.py"/>
    <source>DEM that is subtracted</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/difference.py"/>
    <source>Difference of level</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/difference.py"/>
    <source>Difference of the surfaces</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/difference.py"/>
    <source>Empty for the input itself, where there is no DEM either.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/difference.py"/>
    <source>Give a level to subtract or a DEM, not both.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/difference.py"/>
    <source>Highest difference, in the unit of elevation</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/difference.py"/>
    <source>In the unit of the CRS, where no DEM is given. Empty for the grid of the DEM that the pyramid was made from, and for points their mean spacing.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/difference.py"/>
    <source>Instead of a level; in the CRS of the pyramid. The result is on its grid.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/difference.py"/>
    <source>Level less the other, in the unit of elevation: red is added, blue taken away.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/difference.py"/>
    <source>Level that is subtracted</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/difference.py"/>
    <source>Lowest difference, in the unit of elevation</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/difference.py"/>
    <source>Mean difference, in the unit of elevation</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/difference.py"/>
    <source>Root mean square difference, in the unit of elevation</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/difference.py"/>
    <source>Subtracting the surfaces</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/difference.py"/>
    <source>Subtracts from the surface of one level that of another one, or a DEM: what a generalisation took away, or how a later survey differs at the scale of the level. Above 0 the level is the higher one.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/difference.py"/>
    <source>difference,dod,dem of difference,change,error,residual,compare,level,pyramid,wavelet</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>A region of a tiled pyramid at any level or accuracy, as TIN, raster or mesh</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Extent</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Extract from tiles</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Give a level or the largest error, not both.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Give an extent or polygons, not both.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Gives a region of what &lt;i&gt;Tile large DEM or point clouds&lt;/i&gt; made, at a level or as coarse as a largest error allows, without cracks between tiles. Only the tiles that it needs are read. Triangles that reach into the region are given whole.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>In the unit of the CRS. Empty for the mean spacing of the vertices.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Index of the tiles</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Index of tiles (*.gpkg)</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Instead of a level: fine only where it has to be for no input point of the region to be farther above or below the surface, in the unit of elevation.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Instead: the region is that of all of them. This needs shapely.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Largest error</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Level, or the finest one in the region</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Levels: 0 (coarsest) to {}</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Mesh of the region</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>No output is chosen; choose a TIN, vertices, a raster or a mesh.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Number of triangles</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Number of vertices</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Of the whole: 0 is the coarsest; the number of levels is the input itself.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Or polygons</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Points with elevation and attributes; &lt;i&gt;vertex_id&lt;/i&gt; counts the input's cells.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Raster of the region</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Reading the index</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Reading the tiles</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>TIN of the region</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>The TIN evaluated at the cell centres, 32-bit floats.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>The file &lt;i&gt;index.gpkg&lt;/i&gt; in the folder of the tiles.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>The region, in any CRS. Empty, and no polygons either, for all.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>There is no polygon in the layer; choose another.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Tiles and groups that were read</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Triangles with mean elevation and slope (degrees).</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>Vertices of the region</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>of the surface</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>tiles,index,region,clip,extent,tin,mesh,2dm,raster,level of detail,lod,large,pyramid,wavelet</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_from_tiles.py"/>
    <source>{}: this is no index of tiles; choose index.gpkg in their folder.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_level.py"/>
    <source>0 is the coarsest; the number of levels is the input itself. In the dialog, click a row of the table of levels.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_level.py"/>
    <source>Extract level</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_level.py"/>
    <source>Give one of three: a level, a number of vertices, or the largest error.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_level.py"/>
    <source>In the unit of the CRS. Empty for the grid of the DEM that the pyramid was made from, and for points the mean spacing of the level's vertices.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_level.py"/>
    <source>Instead of a level: exactly this many, from those of the coarsest level to all.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_level.py"/>
    <source>Instead of a level: the smallest size found at which no input point is farther above or below the surface, in the unit of elevation.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_level.py"/>
    <source>Level, or the finer one of two</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_level.py"/>
    <source>Mesh of the level</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_level.py"/>
    <source>One level of a pyramid as TIN, points, raster or mesh</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_level.py"/>
    <source>Points with elevation and attributes; &lt;i&gt;vertex_id&lt;/i&gt; is that of the input.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_level.py"/>
    <source>Raster of the level</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_level.py"/>
    <source>Rounds of refinement</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_level.py"/>
    <source>Rounds of refinement are of the largest error; give both or none.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_level.py"/>
    <source>Synthesises the terrain at one level of a pyramid and gives it as triangles, vertices, a raster or a mesh file for hydraulic models. Instead of a level, give a number of vertices or the largest error, and you get a size between two levels. The log shows how large and how accurate each level is; level 0 is the coarsest.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_level.py"/>
    <source>Synthesising the surface</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_level.py"/>
    <source>TIN of the level</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_level.py"/>
    <source>Vertices of the level</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_level.py"/>
    <source>With the largest error: how often edges are turned, vertices moved, and taken out where it allows. Vertices are then points of the input.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/extract_level.py"/>
    <source>tin,mesh,2dm,raster,level of detail,lod,generalise,generalize,coarse,wavelet,pyramid</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>&lt;i&gt;difference&lt;/i&gt; for a pyramid that was made from a difference of DEMs: red is above zero, blue below.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>A difference of DEMs needs a pyramid that was made from a DEM.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>A pyramid file like the input, with the changed details.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Changes chosen scales of the terrain: damps or boosts the details of each level by a gain, keeps a band of levels or of sizes on the ground, or removes noise while banks and ridges stay. It gives the filtered pyramid and the filtered DEM, point cloud or TIN. Noise is removed first, then gains apply.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Channels to remove noise from, separated by commas: z and attributes.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Choose levels or sizes to keep, not both.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Coarsest level kept</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Difference of the DEMs</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Distance at which the correlation of the noise has fallen to a third, in metres; empty for noise that is white.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Drop details that are larger on the ground, in the same unit.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Drop details that are smaller on the ground, in the unit of x and y, or metres for a geographic CRS. The pyramid may be of any kind.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Drop the details of coarser levels.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Drop the details of finer levels.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Estimate the range of the noise</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Filter levels</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Filtered DEM</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Filtered TIN</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Filtered minus original elevation, for a pyramid of a DEM.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Filtered point cloud</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Filtered pyramid</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Filtering</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Finest level kept</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>From how details fall off over the scales.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Gain</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Gains</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Gains are pairs of a level and a number, such as 5 and 0.5.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>In the unit of elevation; empty to have it estimated from the finest level.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Largest change of elevation</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Largest size kept</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Leave out the coarsest surface</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Measure the noise at each place, as on slopes seen by a laser scanner.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Noise differs by place</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Noise removed from a pyramid, or chosen scales damped, boosted or isolated</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Nothing is chosen to be changed, so noise is removed.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Number of pyramids averaged</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Pyramids in random order, each denoised, whose average leaves no traces of triangles. 0 thresholds the details of a single one, which is quick.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Range of the noise</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Remove noise</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Replace outliers</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Root mean square change of elevation</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Smallest size kept</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>So that the kept details remain by themselves, around zero.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Standard deviation of the noise</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Standard deviation of the noise, in the unit of elevation</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Stripes along</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Such as that of a laser scanner. Done too where nothing else is chosen below.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Take out an offset for each row or column of a DEM, or for each flight line (&lt;i&gt;point_source_id&lt;/i&gt;) of a point cloud.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>The DEM opens as</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>Values that stand out of their ring are replaced before all else.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>What the details of a level are multiplied by: 0 drops them, 0.5 halves, 2 doubles. Levels that are not listed stay. Level 0 is the coarsest.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/filter_levels.py"/>
    <source>denoise,smooth,sharpen,generalise,generalize,band,equaliser,filter,gain,wavelet,pyramid</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/mesh_quality.py"/>
    <source>Angles, edges and areas of the triangles of every level, as a table</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/mesh_quality.py"/>
    <source>Largest angle of the levels, in degrees</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/mesh_quality.py"/>
    <source>Levels</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/mesh_quality.py"/>
    <source>Measures the triangles of each level in plan: what a solver asks of a mesh before it is taken. A sliver is a triangle with an angle below 10 degrees.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/mesh_quality.py"/>
    <source>Measuring the triangles</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/mesh_quality.py"/>
    <source>Mesh quality</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/mesh_quality.py"/>
    <source>Mesh quality by level</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/mesh_quality.py"/>
    <source>Numbers separated by commas; 0 is the coarsest. Empty for all.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/mesh_quality.py"/>
    <source>One row a level. Angles are in degrees, lengths in the unit of the CRS, metres for degrees; &lt;i&gt;low_angle&lt;/i&gt; is what 95 % of the smallest angles are above.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/mesh_quality.py"/>
    <source>Shortest edge of the levels</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/mesh_quality.py"/>
    <source>Smallest angle of the levels, in degrees</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/mesh_quality.py"/>
    <source>The features could not be written ({}); check the disk and the name.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/mesh_quality.py"/>
    <source>mesh quality,triangle quality,angle,sliver,edge length,area,statistics,table,tin,pyramid,wavelet</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>Along the line, whose corners are points, too, in the unit of the CRS, metres for degrees. Empty for the spacing of the input.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>CSV (*.csv)</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>Distance between points</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>Distance, place and heights of every point, for other programs.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>Fields: &lt;i&gt;line&lt;/i&gt;, &lt;i&gt;distance&lt;/i&gt;, and &lt;i&gt;z_…&lt;/i&gt; with the height of each level; NULL where it covers nothing.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>HTML page (*.html)</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>Heights along lines at several levels of a pyramid, as points, table and plot</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>Largest difference from the finest level</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>Length of all lines</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>Lines</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>Lines to walk along, in any CRS; each has charts of its own in the plot.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>No output is chosen; choose points, a plot, a picture or a table.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>Number of lines</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>Numbers separated by commas; 0 is the coarsest. Empty for the input, those with about a quarter and a twentieth of its vertices, and the coarsest.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>Opens in the results viewer and in any browser.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>Picture of the profile</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>Plot of the profile</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>Points of the profile</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>Profile along lines</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>SVG (*.svg)</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>Table of the profile</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>The same plot for print layouts and reports.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>Walking along the lines</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>Walks along lines and reads off the height of several levels of a pyramid. The plot shows them one above the other, and below, how far each is off the finest. The points carry the distance from the start of their line and a height for each level.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>line   level  RMS off the finest  largest</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>profile,section,cross section,transect,elevation profile,plot,chart,level,pyramid,wavelet</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/profile.py"/>
    <source>{}: there is no line; check the layer and its selection.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/quality_report.py"/>
    <source>All numbers of the report, for other programs.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/quality_report.py"/>
    <source>Figures of the report</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/quality_report.py"/>
    <source>Levels shown as pictures</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/quality_report.py"/>
    <source>Measuring and drawing</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/quality_report.py"/>
    <source>Numbers separated by commas. Empty for those with about a quarter and a twentieth of the vertices, and the coarsest.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/quality_report.py"/>
    <source>Quality report</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/quality_report.py"/>
    <source>Sizes, errors and triangle shapes of every level of a pyramid, as a web page</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/quality_report.py"/>
    <source>Writes one HTML page on a pyramid: sizes, errors and triangle quality of every level, curves of the RMSE, histograms of the details, hillshades of the input and of chosen levels, where the error is, and all parameters. The page needs no network.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/quality_report.py"/>
    <source>report,html,rmse,error,accuracy,statistics,triangle quality,pyramid,wavelet</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/reconstruct.py"/>
    <source>'yes' if bit for bit the original</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/reconstruct.py"/>
    <source>Reconstruct</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/reconstruct.py"/>
    <source>Reconstructed DEM</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/reconstruct.py"/>
    <source>Reconstructed TIN</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/reconstruct.py"/>
    <source>Reconstructed point cloud</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/reconstruct.py"/>
    <source>Restoring the input</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/reconstruct.py"/>
    <source>Synthesises the finest level of a pyramid and gives back what it was made from: the DEM bit for bit (same numbers, data type, nodata, grid and CRS), the point cloud with exactly its integers, in its order, or the TIN. A filtered pyramid gives the filtered terrain. Choose the output that fits the pyramid; the others stay empty.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/reconstruct.py"/>
    <source>The DEM, point cloud or TIN that a pyramid was made from, bit for bit</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/reconstruct.py"/>
    <source>synthesis,inverse,dem,las,laz,tin,wavelet,pyramid,original</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>0 is the coarsest. Empty for the input itself, and for residual topography the coarsest.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>0 planar, 1 pit, 2 channel, 3 pass, 4 ridge, 5 peak, of the size of the level.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>&lt;i&gt;windows&lt;/i&gt;: to all that lies within windows two and a half spacings of the level wide, as raster programs do it; &lt;i&gt;surface&lt;/i&gt;: to the surface of the level at its vertices, as &lt;i&gt;Extract level&lt;/i&gt; writes it.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>A landform has a size: the slope of a hill is not that of its furrows. This gives slope, aspect, curvature and landforms of one level, each as smooth as the level, and how high places are above their surroundings. For levels that are of one size on the ground analyse with the partition &lt;i&gt;random&lt;/i&gt; and the prediction &lt;i&gt;plane&lt;/i&gt;.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>Across the descent; spurs are above 0, hollows below.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>Along the descent, in one over the unit of length; convex is above 0.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>Aspect</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>Direction of descent, degrees clockwise from north; nothing on the flat.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>Height above the mean of surroundings of the size of the level.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>Instead of a level: that whose vertices are so far apart, or the nearest, in metres where the CRS states its unit.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>Landforms</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>Mean curvature</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>Measuring the shape of the surface</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>No output is chosen; choose a raster.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>Or distance on the ground</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>Profile curvature</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>Residual topography</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>Ridges and hilltops are above 0, channels and pits below.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>Shape fitted to</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>Slope</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>Slope, aspect and curvature of level</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>Steepest, in degrees.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>Tangential curvature</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>The shape of the terrain at the scale of one level of a pyramid, as rasters</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/shape_of_level.py"/>
    <source>slope,aspect,curvature,profile curvature,plan curvature,tangential,geomorphometry,landform,ridge,channel,peak,pit,pass,residual topography,topographic position,terrain analysis,derivatives,scale,level,pyramid,wavelet</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>Cells with data, or points</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>DEM to the TIN or mesh of a size, or of an accuracy, with a small error</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>Each moves, replaces and reconnects vertices for a smaller error, or for fewer vertices within a tolerance. Empty for as many as pay, 0 for none.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>Fit the heights to all that is given</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>Give one of three: the number of vertices, the largest error, or the RMSE.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>Gives the TIN of a number of vertices, or the TIN that is accurate enough, with a small error at all cells of the DEM. Give one of three: the number of vertices, the largest error, or the root mean square error; with none, a twentieth of the cells become vertices.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>Height and all, also where the RMSE counts: heights are not fitted.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>In the unit of the CRS; empty for the grid of the DEM, or the spacing of points.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>Least squares: the smallest RMSE that these triangles can have. Without it the TIN is the pyramid's coarsest level as it is; where the largest error is kept small, heights are those of the input.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>Measuring the errors</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>Mesh of the TIN</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>No cell or point is farther above or below the TIN, in the unit of elevation.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>No output is chosen; choose a TIN, a raster, a mesh or a pyramid.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>Number of levels</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>RMSE</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>Raster of the TIN</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>Refining the TIN</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>Root mean square error over all cells or points, in the unit of elevation.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>Simplified TIN</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>Simplify DEM to TIN</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>Simplifying (the first run also compiles, up to half a minute)</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>The TIN evaluated at the cell centres.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>The TIN has exactly this many, if it can get there.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>The reversible pyramid whose coarsest level the TIN was made from.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>Vertices are points of the input</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>at all cells or points</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_dem.py"/>
    <source>simplify,thin,generalise,generalize,decimate,reduce,tin,tin from dem,mesh,mesh from dem,dem to mesh,raster to tin,2dm,dem,level of detail,lod</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_point_cloud.py"/>
    <source>Gives the TIN of a number of vertices, or the TIN that is accurate enough, of the ground points of a LAS, LAZ or COPC file, and the points of the file that carry it: few on plains, many on banks. Give one of three: the number of vertices, the largest error, or the root mean square error; with none, a twentieth of the points stay.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_point_cloud.py"/>
    <source>LAS, LAZ or COPC file to the TIN of a size or an accuracy, and fewer points</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_point_cloud.py"/>
    <source>Largest error of the Delaunay TIN of the thinned points</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_point_cloud.py"/>
    <source>Measuring the Delaunay TIN of the points that stay</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_point_cloud.py"/>
    <source>Points of the thinned point cloud</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_point_cloud.py"/>
    <source>RMSE of the Delaunay TIN of the thinned points</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_point_cloud.py"/>
    <source>Simplify point cloud to TIN</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_point_cloud.py"/>
    <source>The points that are the vertices of the TIN, exactly as they were, with all their dimensions. Triangulated again they give other triangles: where a largest error is asked for, points are added until those keep it too. LAZ needs the Python package lazrs.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_point_cloud.py"/>
    <source>Thinned point cloud</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_point_cloud.py"/>
    <source>simplify,thin,thin point cloud,generalise,generalize,decimate,reduce,las,laz,lidar,point cloud,ground,tin,tin from point cloud,mesh,2dm,dtm,level of detail,lod</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/simplify_point_cloud.py"/>
    <source>the thinned point cloud</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/thin_point_cloud.py"/>
    <source>LAS, LAZ or COPC file to those of its points that carry its surface best</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/thin_point_cloud.py"/>
    <source>Thin point cloud</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/thin_point_cloud.py"/>
    <source>Writes the points of a LAS, LAZ or COPC file that carry its surface best, exactly as they were, with all their dimensions: few on plains, many on banks. The ground is taken where the file has it marked. Give one of three: the number of points, the largest error, or the root mean square error of the surface through them; with none, a twentieth stays.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/thin_point_cloud.py"/>
    <source>thin,thinning,decimate,subsample,reduce,simplify,generalise,generalize,las,laz,lidar,point cloud,ground,key points,model key points</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Add the index to the map</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Cancelled; the tiles that were made stay, and the same parameters go on from there.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Folder of tiles</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Making the tiles</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Most levels of a tile</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Number of levels of the whole</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Number of tiles</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Of DEMs in cells, 1024 if empty; a tile of so many needs some 1.7 GB of memory. Of point clouds in the unit of x and y; if empty, such that a tile has about a million points, which need about 1 GB.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Of each tile, and of each group of four. Empty for 64.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Opens the footprints of the tiles, with their sizes and errors.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Reading the headers</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Set aside: stage {}, row {}, column {}: {}</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Side of a tile</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Terrain beyond memory to a tiled pyramid: a file for each tile, and an index</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Tile large DEM or point clouds</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Tile {} of {}: stage {}, row {}, column {}</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Tiles and groups made in this run</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Tiles and groups that were set aside</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Tiles and groups that were there before</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>Turns a DEM or point clouds that need not fit into memory into a pyramid of tiles. Each tile is analysed by itself, its border locked; then two by two tiles become one, up to a single one for the whole. At any level the tiles together are one TIN, without cracks. &lt;i&gt;Extract from tiles&lt;/i&gt; gives any region at any level. A run that was cancelled, or stopped in any other way, goes on where it was when it is started again with the same parameters.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>With &lt;i&gt;index.gpkg&lt;/i&gt; and the tiles. Of an earlier run with the same parameters what is whole is kept; tiles of another input are replaced.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>tile,tiles,large,big,huge,out of core,mosaic,dem,las,laz,copc,ept,lidar,index,pyramid,wavelet</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/tile_terrain.py"/>
    <source>{} tiles, {} with groups, in {} stages</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/web_terrain.py"/>
    <source> zoom   tiles  vertices  largest error (m)</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/web_terrain.py"/>
    <source>0 is the coarsest. Empty for the input itself.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/web_terrain.py"/>
    <source>Empty for the one whose tiles have some 128 points along each side.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/web_terrain.py"/>
    <source>Finest zoom</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/web_terrain.py"/>
    <source>For light and shade.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/web_terrain.py"/>
    <source>Height beyond the data</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/web_terrain.py"/>
    <source>In metres.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/web_terrain.py"/>
    <source>Largest error of the finest zoom, in metres</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/web_terrain.py"/>
    <source>Number of zooms</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/web_terrain.py"/>
    <source>Of the finest zoom, in metres; twice that for the next, and so on. Empty for a tenth of the spacing of the points.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/web_terrain.py"/>
    <source>Quantized-mesh tiles of all zooms for globes such as CesiumJS, and for QGIS</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/web_terrain.py"/>
    <source>Terrain for the web</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/web_terrain.py"/>
    <source>With &lt;i&gt;layer.json&lt;/i&gt; and the tiles. An earlier tile set there is replaced.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/web_terrain.py"/>
    <source>Write normals</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/web_terrain.py"/>
    <source>Writes the terrain as tiles of triangles for all zooms, without cracks between them, each zoom half as far off as the one before. A web server that gives the folder to a globe is all that it takes; QGIS reads it as a quantized-mesh layer.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/web_terrain.py"/>
    <source>Writing the tiles</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/algorithms/web_terrain.py"/>
    <source>quantized mesh,cesium,globe,tiles,terrain,3d,web,layer.json,level,pyramid,wavelet</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/base.py"/>
    <source>Also returned</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/base.py"/>
    <source>Analysis</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/base.py"/>
    <source>Cancelled; nothing was written.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/base.py"/>
    <source>Details</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/base.py"/>
    <source>Parameters</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/base.py"/>
    <source>Quality</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/base.py"/>
    <source>Read off</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/base.py"/>
    <source>Reconstruction</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/base.py"/>
    <source>There is not enough memory for this input (some 700 bytes a vertex are needed). Cut it, or take a coarser one.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Attribute</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>By default the unit that the CRS states; where it states none, metres for a geographic CRS and the unit of x and y for any other. Results keep the input's unit.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>By what the &lt;i&gt;quadric&lt;/i&gt; partition ranks. By default as the paper says.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Cost of the paper's partition</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Error kept small</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>How a removed vertex is estimated from its neighbours; what is left over is its detail. By default &lt;i&gt;barycentric&lt;/i&gt; with the &lt;i&gt;surface&lt;/i&gt; partition, else &lt;i&gt;geometric&lt;/i&gt;.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>How details are passed on to the vertices that stay.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>How far the outline, holes included, may move in plan, in the unit of x and y (metres for a geographic CRS), with the &lt;i&gt;surface&lt;/i&gt; partition. Empty for 0: vertices of the outline are removed only where it runs straight, which limits how coarse a level can become. The log says how much the area changes.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>How many steps of analysis at most (the paper's L). Each removes up to a quarter of the vertices. Fewer come out where nothing more can go. Empty for as many as a rule below takes; without one for 24, not counting those that thin flat parts alone, or 12 with another partition than &lt;i&gt;surface&lt;/i&gt;.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>How much an attribute counts, compared with the elevation, in which vertices are removed and how they are predicted; each is scaled by its range first. 1 where it is not listed, 0 for one that is only carried along.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Largest share removed at a level</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Lifted coordinates</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Most levels</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>No input point is farther above or below the coarsest level, in the unit of elevation.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Partition</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Prediction filter</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Quadrics of the paper's partition</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Stop at this RMSE</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Stop at this largest error</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Stop at this number of vertices</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>The &lt;i&gt;surface&lt;/i&gt; partition removes at most this share of a level's vertices, between 0 and 1; empty for the default. A smaller share makes more levels and takes longer, and the errors are a little smaller.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>The coarsest level has exactly this many vertices, if it can get there; the log says why if it cannot.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>The same for the root mean square over all input points, in the unit of elevation.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>There is no attribute {} to be weighted; {}.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Tolerance of the outline</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Unit of elevation</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Update filter</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Weight</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Weight of bending energy</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Weight of curvature in the cost of the &lt;i&gt;quadric&lt;/i&gt; partition; no unit.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Weights are pairs of an attribute and a number of 0 or more, such as intensity and 0.5.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Weights of attributes</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>What becomes of the quadrics from level to level, with the &lt;i&gt;quadric&lt;/i&gt; partition. By default as the paper says.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>What the &lt;i&gt;surface&lt;/i&gt; partition keeps small. By default &lt;i&gt;rms&lt;/i&gt;, or &lt;i&gt;max&lt;/i&gt; where the largest error is the stop rule.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>What the wavelets transform. By default &lt;i&gt;z&lt;/i&gt;.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>Which vertices are removed at a level (the paper's odd vertices). By default &lt;i&gt;surface&lt;/i&gt;, or &lt;i&gt;quadric&lt;/i&gt; with another filter than &lt;i&gt;barycentric&lt;/i&gt;.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>choose the attributes first</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/analysis_options.py"/>
    <source>those analysed are: {}</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/mesh_output.py"/>
    <source>The suffix chooses the format:</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/mesh_output.py"/>
    <source>coordinates count from an origin that the file names</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/mesh_output.py"/>
    <source>keeps attributes</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/mesh_output.py"/>
    <source>needs the Python package {}</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/pyramid.py"/>
    <source>Add the pyramid to the map</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/pyramid.py"/>
    <source>Input points that the coarsest surface does not cover</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/pyramid.py"/>
    <source>Largest error of the coarsest surface, in the unit of elevation</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/pyramid.py"/>
    <source>Opens the layers in the pyramid file, with their styles, when it is written.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/pyramid.py"/>
    <source>RMSE of the coarsest surface at all input points, in the unit of elevation</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/pyramid.py"/>
    <source>RMSE of the coefficients at the coarsest level (no unit)</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/pyramid.py"/>
    <source>There is no level {}; the levels of this pyramid are 0 (coarsest) to {}.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/pyramid.py"/>
    <source>Triangles of the coarsest level</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/pyramid.py"/>
    <source>Triangles of the input</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/pyramid.py"/>
    <source>Vertices of the coarsest level</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/pyramid.py"/>
    <source>Vertices of the input</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/pyramid.py"/>
    <source>Writing the pyramid</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/pyramid.py"/>
    <source>level   vertices</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/pyramid.py"/>
    <source>level   vertices  triangles  RMSE of surface  largest error</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/pyramid.py"/>
    <source>{}: its CRS is {}, that of the pyramid is {}; reproject it.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/pyramid.py"/>
    <source>{}: of this layer and the terrain only one has a CRS, so their coordinates are taken to be alike (assign the CRS that is missing)</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/restored_output.py"/>
    <source>For a pyramid of a DEM.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/restored_output.py"/>
    <source>For a pyramid of a point cloud file. Needs the Python package laspy.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/restored_output.py"/>
    <source>LAZ (*.laz);;LAS (*.las)</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/restored_output.py"/>
    <source>The triangles of the finest level, for a pyramid of any kind.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/restored_output.py"/>
    <source>This pyramid was made from a DEM; choose where the DEM goes.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/restored_output.py"/>
    <source>This pyramid was made from a TIN; choose where the TIN goes.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/restored_output.py"/>
    <source>This pyramid was made from a point cloud; choose a file for the point cloud, or take the TIN.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/surface_output.py"/>
    <source>Cell size of the raster</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/surface_output.py"/>
    <source>In the unit of the CRS. Empty for the grid of the DEM that the pyramid was made from, and for points their mean spacing.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/surface_output.py"/>
    <source>Input points that the surface does not cover</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/surface_output.py"/>
    <source>Largest error {}, in the unit of elevation</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/surface_output.py"/>
    <source>RMSE {}, in the unit of elevation</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/tolerance.py"/>
    <source>Field with the largest error</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/tolerance.py"/>
    <source>Give a raster of largest errors, or one largest error, not both.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/tolerance.py"/>
    <source>Give zones and the field with their largest error, or neither.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/tolerance.py"/>
    <source>Instead of one number: the largest error by place, in the unit of elevation.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/tolerance.py"/>
    <source>No point of the terrain is inside a zone; check that the layers overlap.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/tolerance.py"/>
    <source>Of the zones, in the unit of elevation.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/tolerance.py"/>
    <source>Polygons with a largest error of their own; where several overlap, the least counts. &lt;i&gt;Largest error&lt;/i&gt; holds outside.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/tolerance.py"/>
    <source>Raster of largest errors</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/tolerance.py"/>
    <source>Within {:g}: {} of {} points are vertices; RMSE {:.4g}, largest error {:.4g}</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/tolerance.py"/>
    <source>Zones of other accuracy</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/parameters/tolerance.py"/>
    <source>{}: no point of the terrain is in a cell of it; check that the layers overlap.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/provider.py"/>
    <source>Terrain Wavelets: reversible multiresolution TINs</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/qgis_io/constraints.py"/>
    <source>{}: there is no breakline here; the TIN is made without.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/qgis_io/constraints.py"/>
    <source>{}: there is no polygon to clip by; check the layer, its filter and selection.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/qgis_io/geopackage.py"/>
    <source>{}: layer {} cannot be written ({}); check the disk and the name.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/qgis_io/laz_unpacker.py"/>
    <source>{}: QGIS's pdal_wrench cannot unpack this file ({}); get it again.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/qgis_io/raster_reader.py"/>
    <source>{}: band {} holds values of type {}; elevations must be real numbers.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/qgis_io/raster_reader.py"/>
    <source>{}: the raster cannot be read ({}); the file is damaged, get it again.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/qgis_io/raster_reader.py"/>
    <source>{}: there is no band {}; the raster has {}.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/qgis_io/raster_writer.py"/>
    <source>{}: GDAL could not write this raster ({}); check the disk and the name.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/qgis_io/raster_writer.py"/>
    <source>{}: no raster of {} can be written under this name; use one ending in .tif.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/qgis_io/training.py"/>
    <source>Feature {}: field {} holds {}; classes are whole numbers from 0 to 254.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/qgis_io/vectors.py"/>
    <source>Feature {}: field {} holds {}, which is no number; fill or filter it.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/qgis_io/vectors.py"/>
    <source>{}: feature {} is no triangle; triangulate the layer first, or give a point layer.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/qgis_io/vectors.py"/>
    <source>{}: the points have no Z; choose the field with the elevation.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/qgis_io/vectors.py"/>
    <source>{}: the triangles have no Z, so they hold no elevations; give a layer whose geometries have Z.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/qgis_io/vectors.py"/>
    <source>{}: what cannot be brought into the CRS of the terrain is left out (features: {}); check the CRS of the layer</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/ui/dependencies.py"/>
    <source>LAS files; the zip of the plugin brings a copy</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/ui/dependencies.py"/>
    <source>LAZ and COPC files</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/ui/dependencies.py"/>
    <source>Terrain Wavelets needs Python {} or later, and this QGIS runs Python {}; install a newer QGIS.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/ui/dependencies.py"/>
    <source>The Python package numba is missing: the work takes two to seven times as long, to refine a TIN within a tolerance 6 to 17 times, with the same result. Install it {} and start QGIS again.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/ui/dependencies.py"/>
    <source>classes learned in Cluster details</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/ui/dependencies.py"/>
    <source>in Terminal</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/ui/dependencies.py"/>
    <source>in a terminal</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/ui/dependencies.py"/>
    <source>in the OSGeo4W Shell (Start menu, QGIS)</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/ui/dependencies.py"/>
    <source>meshes as DXF</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/ui/dependencies.py"/>
    <source>meshes as GLB</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/ui/dependencies.py"/>
    <source>meshes as SELAFIN, for TELEMAC</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/ui/dependencies.py"/>
    <source>meshes for solvers: bounds of angles and edges</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/ui/dependencies.py"/>
    <source>missing Python package: {names}. Install it {remedy} and start QGIS again.</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/ui/dependencies.py"/>
    <source>points and breaklines are triangulated four times as fast</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/ui/dependencies.py"/>
    <source>two to seven times as fast, within a tolerance up to 17 times</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/ui/file_widgets.py"/>
    <source>LAS, LAZ and COPC (*.las *.laz *.LAS *.LAZ)</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/ui/file_widgets.py"/>
    <source>Select a file</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/ui/file_widgets.py"/>
    <source>a point cloud layer of the project, or a file</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/ui/file_widgets.py"/>
    <source>a pyramid of this project or session, or a file</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/ui/file_widgets.py"/>
    <source>largest error</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/ui/file_widgets.py"/>
    <source>level</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/ui/file_widgets.py"/>
    <source>not measured</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/ui/file_widgets.py"/>
    <source>vertices</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/ui/known_pyramids.py"/>
    <source>{} (temporary)</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/ui/known_pyramids.py"/>
    <source>{}: {}, {} levels</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/ui/layer_styles.py"/>
    <source>channel</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/ui/layer_styles.py"/>
    <source>level {}</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/ui/layer_styles.py"/>
    <source>pass</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/ui/layer_styles.py"/>
    <source>peak</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/ui/layer_styles.py"/>
    <source>pit</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/ui/layer_styles.py"/>
    <source>planar</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/ui/layer_styles.py"/>
    <source>ridge</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/ui/options_page.py"/>
    <source>installed</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/ui/options_page.py"/>
    <source>{}: {}; missing, install it {}</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/ui/wording.py"/>
    <source>a layer reprojected before</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/ui/wording.py"/>
    <source>the layer's additional nodata value</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../plugin/ui/wording.py"/>
    <source>the layer's properties</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../PARTITIONS"/>
    <source>in random order, for pyramids that are averaged</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../PARTITIONS"/>
    <source>in the order of their index, regardless of shape</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../PARTITIONS"/>
    <source>those of least cost by generalised quadrics and bending energy</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../PARTITIONS"/>
    <source>those that raise the vertical errors at all input points least</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../NORMS"/>
    <source>the largest vertical error</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../NORMS"/>
    <source>the mean square of the vertical errors</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../PREDICTIONS"/>
    <source>cotangents of the angles opposite each edge, not below 0</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../PREDICTIONS"/>
    <source>from the coarse triangle that now covers the vertex</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../PREDICTIONS"/>
    <source>from the plane fitted to the neighbours; slopes have no details</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../PREDICTIONS"/>
    <source>one over the distance in coordinates and attributes</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../PREDICTIONS"/>
    <source>the mean of the neighbours</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../PREDICTIONS"/>
    <source>the non-negative weights that leave the smallest detail</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../PREDICTIONS"/>
    <source>the same with weights of any sign; can be unstable</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../UPDATES"/>
    <source>half the mean detail of the odd neighbours, by their prediction weights</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../UPDATES"/>
    <source>keeps the mean of each removed vertex's ring</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../UPDATES"/>
    <source>keeps the weighted mean height at every level</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../UPDATES"/>
    <source>the vertices that stay keep their heights (subsampling)</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../SIGNALS"/>
    <source>all coordinates, as in the paper; coarse faces may be flipped in plan</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../SIGNALS"/>
    <source>elevation and attributes; every level is a valid TIN</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../QUADRICS"/>
    <source>built anew on every level</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../QUADRICS"/>
    <source>built on the input, handed on (Eqs. 52-53)</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../COSTS"/>
    <source>the least of them, which is that of the collapse</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../COSTS"/>
    <source>the sum over the neighbours' quadrics (Eq. 36)</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../MESH_FORMATS"/>
    <source>3D printers</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../MESH_FORMATS"/>
    <source>3D software</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../MESH_FORMATS"/>
    <source>3D viewers, web pages</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../MESH_FORMATS"/>
    <source>CAD</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../MESH_FORMATS"/>
    <source>CAD, machine control</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../MESH_FORMATS"/>
    <source>QGIS (as a mesh layer), D-Flow FM, xugrid</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../MESH_FORMATS"/>
    <source>QGIS (as a mesh layer), hydraulic models</source>
    <translation type="unfinished"></translation>
  </message>
  <message>
    <location filename="../../MESH_FORMATS"/>
    <source>TELEMAC, QGIS (as a mesh layer)</source>
    <translation type="unfinished"></translation>
  </message>
</context>
</TS>
