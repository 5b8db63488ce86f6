MODULE edge
  ! an edge in the workpiece frame
  CONST robtarget p1:=[[-100,0,0],[0,1,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget p2:=[[0,0,0],[0,1,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  PROC main()
    MoveAbsJ [[0,0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]],v100,fine,spindle\WObj:=part;
    MoveL p1,v50,fine,spindle\WObj:=part;
    MoveL p2,v50,z1,spindle\WObj:=part;
    MoveC [[35.355,14.645,0],[0,1,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],[[50,50,0],[0,1,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],v50,z1,spindle\WObj:=part;
    MoveL [[50,100,5],[0,0.999962,0.008727,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],v50,fine,spindle\WObj:=part;
  ENDPROC
ENDMODULE
