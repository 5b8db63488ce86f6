/PROG  EDGE
/ATTR
OWNER		= MNEDITOR;
/MN
   1:  UFRAME_NUM=1 ;
   2:  UTOOL_NUM=1 ;
   3:L P[1:"start"] 50mm/sec FINE ;
   4:L P[2] 50mm/sec CNT100 ;
   5:C P[3]
    :  P[4] 50mm/sec CNT100 ;
/POS
P[1:"start"]{
   GP1:
	UF : 1, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X =  -100.000  mm,	Y =     0.000  mm,	Z =     0.000  mm,
	W =   180.000 deg,	P =     0.000 deg,	R =     0.000 deg
};
P[2]{
   GP1:
	UF : 1, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X =     0.000  mm,	Y =     0.000  mm,	Z =     0.000  mm,
	W =   180.000 deg,	P =     0.000 deg,	R =     0.000 deg
};
P[3]{
   GP1:
	UF : 1, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X =    35.355  mm,	Y =    14.645  mm,	Z =     0.000  mm,
	W =   180.000 deg,	P =     0.000 deg,	R =     0.000 deg
};
P[4]{
   GP1:
	UF : 1, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X =    50.000  mm,	Y =    50.000  mm,	Z =     0.000  mm,
	W =   180.000 deg,	P =     1.000 deg,	R =     0.000 deg
};
/END
