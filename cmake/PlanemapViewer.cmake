# The page of the daemon: built by npm from clients/viewer, and embedded.
include_guard(GLOBAL)

option(PLANEMAP_VIEWER "Build the viewer's page with npm, where npm and its sources are there" ON)

# planemap_viewer_page(folder_variable index_variable)
# Sets the folder that is to be embedded, and its index.html, which a rule makes where npm does. Without npm a page that was built
# before (clients/viewer/dist) is taken, and without that one that says how to build it.
function(planemap_viewer_page folder_variable index_variable)
  set(viewer "${PROJECT_SOURCE_DIR}/clients/viewer")
  find_program(PLANEMAP_NPM npm)
  if(PLANEMAP_VIEWER AND PLANEMAP_NPM AND EXISTS "${viewer}/package.json")
    set(folder "${PROJECT_BINARY_DIR}/viewer")
    set(installed "${viewer}/node_modules/.package-lock.json")
    file(GLOB_RECURSE sources CONFIGURE_DEPENDS "${viewer}/src/*" "${viewer}/public/*" "${viewer}/build/*")
    add_custom_command(
      OUTPUT "${installed}"
      COMMAND "${PLANEMAP_NPM}" ci --no-audit --no-fund
      DEPENDS "${viewer}/package.json" "${viewer}/package-lock.json"
      WORKING_DIRECTORY "${viewer}"
      COMMENT "npm ci, for the viewer (off: -DPLANEMAP_VIEWER=OFF)"
      VERBATIM)
    add_custom_command(
      OUTPUT "${folder}/index.html"
      COMMAND "${PLANEMAP_NPM}" run build -- --outDir "${folder}" --emptyOutDir
      DEPENDS "${installed}" "${viewer}/index.html" "${viewer}/vite.config.ts" ${sources}
      WORKING_DIRECTORY "${viewer}"
      COMMENT "Viewer"
      VERBATIM)
  elseif(PLANEMAP_VIEWER AND EXISTS "${viewer}/dist/index.html")
    set(folder "${viewer}/dist")
  else()
    set(folder "${PROJECT_SOURCE_DIR}/service/src/serve/http/fallback")
    message(STATUS "planemapd gets no viewer: npm or clients/viewer is missing, or PLANEMAP_VIEWER is off")
  endif()
  set(${folder_variable} "${folder}" PARENT_SCOPE)
  set(${index_variable} "${folder}/index.html" PARENT_SCOPE)
endfunction()
